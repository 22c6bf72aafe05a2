export function png(width: number, height: number, colourAt: (x: number, y: number) => readonly number[]): Uint8Array;
