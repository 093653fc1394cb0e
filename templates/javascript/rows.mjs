/** Numbers as rows of so many. */
function _rows(values, columns) {
  const rows = [];
  for (let start = 0; start < values.length; start += columns) {
    rows.push(values.slice(start, start + columns));
  }
  return rows;
}
