// Every key of the page, in one list: what it does, and for the reader what it is.
import { find, table } from './elements.js';

/** @param actions  what the keys do, by name */
export function listen(actions) {
  const keys = [
    [['Space'], 'play or pause', () => actions.toggle()],
    [['ArrowLeft', ','], 'one tick back', () => actions.step(-1)],
    [['ArrowRight', '.'], 'one tick on', () => actions.step(1)],
    [['PageUp'], 'a tenth of a second back', () => actions.step(-actions.tenth())],
    [['PageDown'], 'a tenth of a second on', () => actions.step(actions.tenth())],
    [['Home'], 'to the beginning', () => actions.go(0)],
    [['End'], 'to the end', () => actions.go(Infinity)],
    [['['], 'event before', () => actions.event(-1)],
    [[']'], 'next event', () => actions.event(1)],
    [['-'], 'slower', () => actions.faster(-1)],
    [['+', '='], 'faster', () => actions.faster(1)],
    [['1'], 'view: around', () => actions.mode('around')],
    [['2'], 'view: left eye', () => actions.mode('left')],
    [['3'], 'view: right eye', () => actions.mode('right')],
    [['4'], 'view: both eyes', () => actions.mode('both')],
    [['b'], 'of two trials: A, B or both; of one: the trial, simulated again, or both', () => actions.pair()],
    [['t'], 'trails', () => actions.layer('trails')],
    [['v'], 'view frusta', () => actions.layer('frusta')],
    [['c'], 'impulses', () => actions.layer('contacts')],
    [['a', 'd', 'w', 's'], 'turn the camera', (key) => actions.orbit(key)],
    [['r', 'f'], 'nearer, farther', (key) => actions.orbit(key)],
  ];
  find('keys-body').append(table('What keys do', ['Key', 'Does'],
    keys.map(([names, does]) => [names.join(' '), does])));
  // After a click Space plays; after a Tab it is of the button that the Tab went to.
  let clicked = false;
  document.addEventListener('pointerdown', () => { clicked = true; }, true);
  document.addEventListener('keydown', (event) => { if (event.key === 'Tab') clicked = false; }, true);
  document.addEventListener('keydown', (event) => {
    if (!find('keys-on').checked && document.activeElement !== find('view')) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key === ' ' ? 'Space' : event.key;
    if (key === 'Space' && clicked && !isTyped(event.target)) event.target.blur();
    else if (isTaken(event.target, key)) return;
    const found = keys.find(([names]) => names.includes(key));
    if (!found) return;
    event.preventDefault();
    found[2](key);
  });
}

/** Whether a space is a letter there. */
function isTyped(element) {
  return element.matches('textarea, input[type=text]');
}

/** Whether the element under the keys has its own use for one. */
function isTaken(element, key) {
  if (element.matches('select, textarea, input[type=file]')) return true;
  if (element.matches('button, summary, input[type=checkbox]')) return key === 'Space';
  if (element.matches('input[type=radio]')) return key === 'Space' || key.startsWith('Arrow');
  if (element.matches('#scrub')) return false;  // its tick is the clock's: ours are the same steps
  if (element.matches('input')) return true;
  return element.matches('[role=region]') && /^(Arrow|Page|Home|End)/.test(key);
}
