/** How many orientations there are, how far each argument goes on, and where results go. */
function _many(out, width, given) {
  const counts = given.map(([name, values, size]) => {
    if (values == null || !Number.isInteger(values.length / size)) {
      const found = values?.length ?? values;
      throw new RangeError(`${name}: expected rows of ${size} numbers, got ${found} numbers`);
    }
    if (!ArrayBuffer.isView(values)) _check_numbers(name, values); // others hold nothing else
    return values.length / size;
  });
  const count = counts.find((rows) => rows !== 1) ?? 1;
  given.forEach(([name], k) => {
    if (counts[k] !== 1 && counts[k] !== count) {
      throw new RangeError(`${name}: expected ${count} rows or one, got ${counts[k]}`);
    }
  });
  const result = out ?? new Float64Array(count * width);
  if (result.length !== count * width) {
    const expected = `${count} rows of ${width} numbers`;
    throw new RangeError(`out: expected ${expected}, got ${result.length} numbers`);
  }
  return { count, steps: given.map(([, , size], k) => (counts[k] === 1 ? 0 : size)), result };
}
