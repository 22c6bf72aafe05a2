// SPDX-License-Identifier: MIT
// What links tell of rooms: `dollhouse=on|off`, `walk=on`, and `storey=FROM,TO`: heights of the input between which all is drawn.
import type { DollhouseMode } from '../../src/plugins/dollhouse.js';

export interface RoomsLink {
  /// `auto`: the link says nothing.
  readonly dollhouse: DollhouseMode;
  readonly isWalking: boolean;
  readonly storey: readonly [number, number] | null;
}

const NAMES = ['dollhouse', 'walk', 'storey'];
const DIGITS = 12;

/// As links have it; null: all is as it is without a choice.
export function formatRoomsLink({ dollhouse, isWalking, storey }: RoomsLink): string | null {
  const parts = [
    dollhouse === 'auto' ? '' : `dollhouse=${dollhouse}`,
    isWalking ? 'walk=on' : '',
    storey === null ? '' : `storey=${storey.map((height) => String(Number(height.toPrecision(DIGITS)))).join()}`,
  ].filter((part) => part !== '');
  return parts.length === 0 ? null : parts.join('&');
}

/// The part of a link's choices that tells of rooms; null: none does.
export function roomsOfChoices(choices: string): string | null {
  const parts = choices.split('&').filter((part) => NAMES.some((name) => part.startsWith(`${name}=`)));
  return parts.length === 0 ? null : parts.join('&');
}

function parseStorey(text: string | null): RoomsLink['storey'] {
  const numbers = text?.split(',').map((part) => (part.trim() === '' ? NaN : Number(part))) ?? [];
  const [from, to] = numbers;
  return numbers.length === 2 && numbers.every(Number.isFinite) && from < to ? [from, to] : null;
}

/// What cannot be read is as if it were not there.
export function parseRoomsLink(text: string | null): RoomsLink {
  const choices = new URLSearchParams(text ?? '');
  const dollhouse = choices.get('dollhouse');
  return { dollhouse: dollhouse === 'on' || dollhouse === 'off' ? dollhouse : 'auto', isWalking: choices.get('walk') === 'on', storey: parseStorey(choices.get('storey')) };
}
