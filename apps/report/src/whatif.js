// What other releases of a throw would have felled: pictures that the program drew, and their numbers.
import { hasBlock, jsonBlock } from './data.js';
import { facts, find, make, number, table } from './elements.js';

const kNone = '–';

function picture(svg, words) {
  const url = URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' }));
  return make('figure', { class: 'drawn' }, make('img', { src: url, alt: words }),
    make('figcaption', {}, words));
}

export async function showWhatIf() {
  if (!hasBlock('whatif')) return;
  const { lines, moments_svg: moments, map_svg: map, moments: rows } = await jsonBlock('whatif');
  const shown = (value) => (value === null ? kNone : number(value));
  find('whatif-body').replaceChildren(
    facts(lines),
    picture(moments, 'Skittles down, speed and direction of the ball for each moment of the release'),
    picture(map, 'Skittles down for other directions and speeds, a map for each height and spin; '
      + 'the red cross is the real throw, rings are all throws'),
    make('details', {}, make('summary', {}, 'Each moment as a table'),
      table('Other moments of the release',
        ['Later [ms]', 'Speed [m/s]', 'Direction to the right [degrees]', 'Skittles down'],
        rows.map((row) => row.map(shown)))));
  find('whatif').hidden = false;
}
