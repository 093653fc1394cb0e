/**
 * c_k of n² for each order k: c0 = cos n, c1 = sin n/n, c_(k+2) = (c_k(0) - c_k)/n².
 *
 * The first three follow from t = tan(n/2), which leaves c2 its digits where it vanishes.
 */
function _entire(square, ...orders) {
  const half = 0.5 * sqrt(square);
  const t = tan(half);
  const scale = 1.0 + t * t;
  const ratio = half > 0.0 ? t / half : 1.0;
  const values = [(1.0 - t * t) / scale, ratio / scale, (0.5 * ratio * ratio) / scale];
  for (let order = 3; order <= Math.max(...orders); order += 1) {
    const [end, start, ...coefficients] = _SERIES[order];
    values.push(
      square < end
        ? coefficients.reduceRight((value, coefficient) => value * square + coefficient)
        : (start - values[order - 2]) / square,
    );
  }
  return orders.map((order) => values[order]);
}
