// SPDX-License-Identifier: MIT
// Makes shader texts shorter: without what is never drawn, without comments and indents.
//
//   #ifdef USE_FOG            nothing here has fog: gone
//     ...
//   #endif
//   #if defined( USE_MAP ) || defined( USE_FOG )    may be: stays, with its branches
//
// Invariant: what a compiler sees is the same where no macro of `absent` is defined and each of `zeros` is 0.

/// A condition holds, does not, or it is not known before a program is made.
type Truth = '1' | '0' | '?';

/// Macros that no program defines, and those that are 0 in each.
export interface KnownMacros {
  readonly absent: RegExp;
  readonly zeros: RegExp;
}

function both(a: string, b: string): Truth {
  if (a === '0' || b === '0') return '0';
  return a === '1' && b === '1' ? '1' : '?';
}

const NOT: Readonly<Record<string, Truth>> = { 0: '1', 1: '0', '?': '?' };

/// Inner parentheses first, `&&` before `||`.
function reduced(expression: string): string {
  return expression
    .replace(/!([01?])/, (_, a: string) => NOT[a])
    .replace(/\(([01?])\)/, '$1')
    .replace(/([01?])&&([01?])/, (_, a: string, b: string) => both(a, b))
    .replace(/(?<!&&)([01?])\|\|([01?])(?!&&)/, (_, a: string, b: string) => NOT[both(NOT[a], NOT[b])]);
}

function truthOf(condition: string, { absent, zeros }: KnownMacros): Truth {
  let left = condition
    .replace(/defined\s*\(\s*(\w+)\s*\)/g, (_, macro: string) => (absent.test(macro) ? '0' : '?'))
    .replace(/\b(\w+)\s*>\s*0\b/g, (_, macro: string) => (zeros.test(macro) ? '0' : '?'))
    .replace(/\w+\s*[<>=!]+\s*\w+/g, '?')
    .replace(/\s/g, '');
  for (let before = ''; before !== left; left = reduced(left)) before = left;
  return left === '0' || left === '1' ? left : '?';
}

/// One #if … #endif.
interface Choice {
  /// Lines around it are kept.
  readonly isInside: boolean;
  /// A branch before holds for certain: no other one counts.
  isOver: boolean;
  /// A directive of it is kept, and so must the last one be.
  isWritten: boolean;
}

class Pruner {
  private readonly choices: Choice[] = [];
  private readonly lines: string[] = [];
  private keeps = true;

  constructor(private readonly macros: KnownMacros) {}

  take(line: string): void {
    const directive = /^#\s*(if|ifdef|ifndef|elif|else|endif)\b\s*(.*)$/.exec(line);
    if (directive === null) {
      if (this.keeps) this.lines.push(line);
    } else if (directive[1] === 'endif') this.end();
    else if (directive[1].startsWith('if')) this.begin(directive[1], directive[2]);
    else this.other(directive[1] === 'else' ? '1' : truthOf(directive[2], this.macros), directive[2]);
  }

  /// Throws Error if a choice is still open.
  finish(): string[] {
    if (this.choices.length > 0) throw new Error('an #if of a shader has no #endif');
    return this.lines;
  }

  private begin(what: string, rest: string): void {
    const condition = what === 'if' ? rest : `${what === 'ifndef' ? '!' : ''}defined(${rest})`;
    this.choices.push({ isInside: this.keeps, isOver: false, isWritten: false });
    this.branch(truthOf(condition, this.macros), what === 'if' ? `#if ${rest}` : `#${what} ${rest}`);
  }

  private other(truth: Truth, condition: string): void {
    const { isWritten } = this.choice();
    this.branch(truth, truth === '1' ? '#else' : `#${isWritten ? 'elif' : 'if'} ${condition}`);
  }

  /// `directive`: tells of the branch, if it is not known whether it holds, or one before does.
  private branch(truth: Truth, directive: string): void {
    const choice = this.choice();
    this.keeps = choice.isInside && !choice.isOver && truth !== '0';
    if (!this.keeps) return;
    const isKnown = truth === '1' && !choice.isWritten;
    choice.isOver = truth === '1';
    choice.isWritten ||= !isKnown;
    if (!isKnown) this.lines.push(directive);
  }

  private end(): void {
    const { isInside, isWritten } = this.choice();
    this.choices.pop();
    this.keeps = isInside;
    if (isWritten) this.lines.push('#endif');
  }

  private choice(): Choice {
    const choice = this.choices.at(-1);
    if (choice === undefined) throw new Error('an #endif of a shader has no #if');
    return choice;
  }
}

/// Directives are told by their lines, and `#include <chunk>` by its text.
function tightened(line: string): string {
  return line.startsWith('#') ? line : line.replace(/\s*([=<>,;(){}?:*[\]])\s*/g, '$1');
}

/// Returns a text that compiles to the same. Throws Error if it is none of whole choices.
export function leanShader(text: string, macros: KnownMacros): string {
  const pruner = new Pruner(macros);
  const bare = text.replace(/\/\*[\s\S]*?\*\//g, '').replace(/\/\/.*/g, '');
  for (const line of bare.split('\n').map((each) => each.trim())) if (line !== '') pruner.take(line);
  return pruner.finish().map(tightened).join('\n');
}
