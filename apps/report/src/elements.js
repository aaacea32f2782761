// Small helpers for the page's elements. Whatever comes from a trial goes in as text, never as HTML.
export { number } from './words.js';

export const find = (id) => document.getElementById(id);

/** An element with attributes and children; strings and numbers become text. */
export function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) element.addEventListener(key.slice(2), value);
    else if (value !== undefined && value !== null) element.setAttribute(key, value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined)
    .map((child) => (child instanceof Node ? child : String(child))));
  return element;
}

/** A table that can be scrolled by keys where it is wide. */
export function table(caption, head, rows) {
  return make('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption },
    make('table', {},
      make('caption', {}, caption),
      make('thead', {}, make('tr', {}, head.map((text) => make('th', { scope: 'col' }, text)))),
      make('tbody', {}, rows.map((row) => make('tr', {}, row.map((cell, i) =>
        (i === 0 ? make('th', { scope: 'row' }, cell) : make('td', {}, cell))))))));
}

/** Names and values in two columns. */
export function facts(entries) {
  return make('dl', {}, entries.flatMap(([name, value]) =>
    [make('dt', {}, name), make('dd', {}, value)]));
}
