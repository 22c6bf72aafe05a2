// What failed and what to do, in a region that can be dismissed.
import { element, iconButton } from './parts/element.js';
import { ICONS } from './parts/icons.js';

const MOST_SHOWN = 3;

export class Problems {
  readonly root = element('div', { class: 'problems', role: 'alert' });

  private readonly dismissed = new Set<string>();

  /// The same message is shown once, and not again when it was dismissed. What it returns takes the message away.
  tell(message: string): () => void {
    if (this.dismissed.has(message)) return () => undefined;
    const shown = [...this.root.children].find((child) => child.firstChild?.textContent === message);
    if (shown !== undefined) return () => { shown.remove(); };
    const problem = element('div', { class: 'problem' }, element('p', {}, message));
    problem.append(iconButton('Dismiss', ICONS.close, () => {
      this.dismissed.add(message);
      problem.remove();
    }));
    this.root.append(problem);
    if (this.root.children.length > MOST_SHOWN) this.root.firstElementChild?.remove();
    return () => { problem.remove(); };
  }

  clear(): void {
    this.dismissed.clear();
    this.root.replaceChildren();
  }
}
