// The questionnaire of a study, asked after the game.
import { find, make } from '../elements.js';

const kNone = 'n/a';
const kSoFar = `headpin ${location.pathname}`;

/** {key, answers} of a guest until they are stored: for the same tab, when its page is loaded again. */
export const answersSoFar = {
  read() {
    try {
      return JSON.parse(sessionStorage.getItem(kSoFar)) ?? {};
    } catch {
      return {};  // this browser keeps nothing
    }
  },
  keep(more) {
    try {
      sessionStorage.setItem(kSoFar, JSON.stringify({ ...this.read(), ...more }));
    } catch {
      // This browser keeps nothing: the page asks before it is closed.
    }
  },
  forget() {
    try {
      sessionStorage.removeItem(kSoFar);
    } catch {
      // This browser keeps nothing.
    }
  },
};

function choicesOf(item, language) {
  if (item.choices.length > 0) return item.choices.map(({ id, text }) => [id, text[language]]);
  const numbers = [];
  for (let i = item.low; i <= item.high; ++i) numbers.push([String(i), String(i)]);
  return numbers;
}

function question(item, number, language) {
  const scale = item.choices.length === 0;
  const answers = [...choicesOf(item, language), [kNone, 'no answer']].map(([value, text]) =>
    make('label', {}, make('input', { type: 'radio', name: item.id, value, required: '' }), ` ${text}`));
  const ends = scale ? [make('p', { class: 'note' },
    `${item.low}: ${item.low_end[language]}. ${item.high}: ${item.high_end[language]}.`)] : [];
  return make('fieldset', { class: 'question' },
    make('legend', {}, `${number}. ${item.text[language]}`), ...ends, make('div', { class: 'answers' }, ...answers));
}

/**
 * Shows the questions, and waits until all are answered.
 * @param store  takes the answers by item; may throw in words, then it is tried again unless its status is 409:
 *               others have been stored
 */
export function ask({ items, languages }, store) {
  const language = languages.find((one) => navigator.language.startsWith(one)) ?? languages[0];
  const trouble = make('p', { role: 'alert' });
  const send = make('button', { type: 'submit', class: 'main', id: 'send-answers' }, 'Send the answers');
  const form = make('form', { id: 'questions-form', lang: language },
    ...items.map((item, i) => question(item, i + 1, language)),
    send, trouble);
  for (const [item, value] of Object.entries(answersSoFar.read().answers ?? {})) {
    const answers = form.elements.namedItem(item);
    if (answers) answers.value = value;
  }
  form.addEventListener('change', () => answersSoFar.keep({ answers: Object.fromEntries(new FormData(form)) }));
  find('questions').hidden = false;
  find('questions-body').replaceChildren(form);
  find('questions-heading').focus();
  return new Promise((resolve) => {
    const end = (words) => {
      answersSoFar.forget();
      find('questions-body').replaceChildren(make('p', {}, words));
      resolve();
    };
    form.addEventListener('submit', async (event) => {
      event.preventDefault();
      send.disabled = true;
      try {
        await store(Object.fromEntries(new FormData(form)));
        end('Thank you. The answers are stored.');
      } catch (error) {
        if (error.status === 409) end('The answers that were sent first are stored; these are not.');
        else trouble.textContent = `The answers were not stored: ${error.message}. Please try again.`;
      }
      send.disabled = false;
    });
  });
}
