export const NO_WEBGL =
  'This browser has no WebGL 2, which the page draws with. Another browser may have it, or this one with its graphics acceleration on.';
