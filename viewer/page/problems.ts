// What failed and what to do, in a region that can be dismissed.
import { element, iconButton } from './parts/element.js';
import { ICONS } from './parts/icons.js';

const MOST_SHOWN = 3;

export class Problems {
  readonly root = element('div', { class: 'problems', role: 'alert' });

  /// The same message is shown once. What it returns takes the message away.
  tell(message: string): () => void {
    const shown = [...this.root.children].find((child) => child.firstChild?.textContent === message);
    if (shown !== undefined) return () => { shown.remove(); };
    const problem = element('div', { class: 'problem' }, element('p', {}, message));
    problem.append(iconButton('Dismiss', ICONS.close, () => { problem.remove(); }));
    this.root.append(problem);
    if (this.root.children.length > MOST_SHOWN) this.root.firstElementChild?.remove();
    return () => { problem.remove(); };
  }

  clear(): void {
    this.root.replaceChildren();
  }
}
