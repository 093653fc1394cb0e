/**
 * What divides, or NaN where its size is at most eps**power times that of `scale`; without
 * a scale, where it is at most the smallest normal number over eps.
 */
function _or_nan(value, scale, power = 1) {
  const least = scale === null ? 2 ** -970 : 2 ** (-52 * power) * abs(scale);
  return abs(value) > least ? value : NaN;
}
