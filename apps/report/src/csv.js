// Tables as text that other programs read.

/** A field as RFC 4180 has it: one with a comma, a quotation mark or a line break is in quotation marks. */
function field(text) {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** A table as CSV; a value that is not there is an empty field. */
export function csvOf(names, rows) {
  return [names.map(field), ...rows].map((row) => row.join(',')).join('\r\n');
}
