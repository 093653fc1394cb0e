/** The entries of a matrix, row by row. */
function _flat(name, matrix, columns) {
  if (matrix == null || typeof matrix[0] === "number") return matrix;
  const wrong = Array.from(matrix).find((row) => row?.length !== columns);
  if (wrong !== undefined) {
    throw new RangeError(`${name}: expected rows of ${columns} numbers, got ${wrong}`);
  }
  return Array.from(matrix).flatMap((row) => [...row]);
}
