/** The components of an argument, or an error that names it. */
function _taken(name, values, count) {
  if (values == null || values.length !== count) {
    throw new RangeError(`${name}: expected ${count} numbers, got ${values?.length ?? values}`);
  }
  _check_numbers(name, values);
  return values;
}

/** Texts are refused: where one is added to another, they would be joined. */
function _check_numbers(name, values) {
  for (let k = 0; k < values.length; k += 1) {
    if (typeof values[k] !== "number") {
      const found = values[k] === null ? "null" : typeof values[k];
      throw new TypeError(`${name}: expected numbers, got ${found} at ${k}`);
    }
  }
}
