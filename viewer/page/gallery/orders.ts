// SPDX-License-Identifier: MIT
// In which order models may be shown. `folder`: in groups by folder, in each by name.
export const ORDERS = ['folder', 'name', 'newest', 'size', 'triangles'] as const;
export type Order = (typeof ORDERS)[number];
