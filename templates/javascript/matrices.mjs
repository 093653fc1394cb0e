/** The entries of a matrix, row by row. */
function _flat(matrix) {
  return matrix == null ? matrix : Array.from(matrix).flat();
}
