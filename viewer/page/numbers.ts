// Numbers for people. Every function takes any number, and what is no number becomes a dash.

const DASH = '–';
const plain = new Intl.NumberFormat('en');
const UNITS = ['B', 'kB', 'MB', 'GB', 'TB', 'PB'] as const;

function isSize(value: number): boolean {
  return Number.isFinite(value) && value >= 0;
}

/// Three digits: 1.23, 12.3, 123.
function threeDigits(value: number): string {
  return value.toFixed(value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

/// 28,184,526.
export function formatCount(value: number): string {
  return isSize(value) ? plain.format(Math.round(value)) : DASH;
}

/// 28.2 M.
export function formatRough(value: number): string {
  if (!isSize(value)) return DASH;
  if (value < 10_000) return plain.format(Math.round(value));
  if (value < 999_500) return `${threeDigits(value / 1e3)} k`;
  return value < 999_500_000 ? `${threeDigits(value / 1e6)} M` : `${threeDigits(value / 1e9)} G`;
}

/// 23.5 MB, in powers of 1000.
export function formatBytes(value: number): string {
  if (!isSize(value)) return DASH;
  let unit = 0;
  for (; value >= 999.5 && unit < UNITS.length - 1; ++unit) value /= 1000;
  return `${unit === 0 ? String(Math.round(value)) : threeDigits(value)} ${UNITS[unit]}`;
}

/// 820 ms, 4.25 s.
export function formatMilliseconds(value: number): string {
  if (!isSize(value)) return DASH;
  return value < 999.5 ? `${value.toFixed(0)} ms` : `${threeDigits(value / 1000)} s`;
}

/// 12 s, 3 min, 2 h 5 min.
export function formatDuration(seconds: number): string {
  if (!isSize(seconds)) return DASH;
  if (seconds < 99.5) return `${Math.round(seconds)} s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/// 0.83, 12.5; large ones without a fraction.
export function formatDecimal(value: number): string {
  if (!isSize(value)) return DASH;
  return value >= 1000 ? formatCount(value) : threeDigits(value);
}
