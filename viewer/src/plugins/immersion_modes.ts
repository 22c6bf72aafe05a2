// SPDX-License-Identifier: MIT
// Asks what the device can do, without asking the visitor.

export type ImmersionMode = 'immersive-vr' | 'immersive-ar';

const MODES: readonly ImmersionMode[] = ['immersive-vr', 'immersive-ar'];

/// Without WebXR, or in a page that may not use it, none.
export async function immersionModes(): Promise<ImmersionMode[]> {
  const { xr } = navigator as { xr?: XRSystem };
  if (xr === undefined) return [];
  const able = await Promise.all(MODES.map((mode) => xr.isSessionSupported(mode).catch(() => false)));
  return MODES.filter((_, i) => able[i]);
}
