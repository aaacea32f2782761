// Curves of many rows, as a plot can show them.

const kMostPoints = 3000;  // of a curve, on a plot 1200 pixels wide

/** Rows of the least and the greatest of values [from, to); none where there is no number. */
function extremes(values, from, to) {
  let [low, high] = [-1, -1];
  for (let row = from; row < to; ++row) {
    if (low < 0 ? !Number.isNaN(values[row]) : values[row] < values[low]) low = row;
    if (high < 0 ? !Number.isNaN(values[row]) : values[row] > values[high]) high = row;
  }
  return low < 0 ? [] : [low, high];
}

/**
 * Columns of fewer rows: of each few, those in which a curve has its least or its greatest value, and the first and the last of all.
 * @return  times and the values of each curve, at their own times and in their order
 */
export function thinned({ times, curves }) {
  const columns = [times, ...curves.map(([, values]) => values)];
  if (times.length <= kMostPoints) return columns;
  const group = Math.ceil((2 * curves.length * times.length) / kMostPoints);
  const kept = new Set([0]);
  for (let from = 0; from < times.length; from += group) {
    const to = Math.min(from + group, times.length);
    const rows = curves.flatMap(([, values]) => extremes(values, from, to));
    for (const row of rows.length > 0 ? rows.sort((a, b) => a - b) : [from]) kept.add(row);
  }
  kept.add(times.length - 1);
  const rows = [...kept];
  return columns.map((values) => Float64Array.from(rows, (row) => values[row]));
}
