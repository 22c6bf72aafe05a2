// SPDX-License-Identifier: MIT
/// A picture is by so much larger than the model in it.
export const FRAME_MARGIN = 1.08;
