// The page's words in English. Every other table has the same keys: `Words` sees to it.
// A group for each part of the page. Words with something in them are functions; numbers come written out, with the
// count beside them where the words depend on it.

/// `text`: the count, written out.
function counted(count: number, text: string, one: string, more: string): string {
  return `${text} ${count === 1 ? one : more}`;
}

export const en = {
  /// What the language calls itself.
  language: 'English',
  title: (name: string) => `${name} – meshhier`,
  parts: {
    close: (what: string) => `Close ${what.toLowerCase()}`,
    dismiss: 'Dismiss',
    language: 'Language',
    retry: 'Retry',
    theme: (name: string) => `Theme: ${name}`,
  },
  themes: { auto: 'Auto', light: 'Light', dark: 'Dark' },
  modes: { CWV: 'Whole model', ZSV: 'Part of the model', DZM: 'Original triangles' },
  counts: {
    models: (count: number, text: string) => counted(count, text, 'model', 'models'),
    vertices: (count: number, text: string) => counted(count, text, 'vertex', 'vertices'),
    triangles: (count: number, text: string) => counted(count, text, 'triangle', 'triangles'),
    bytes: (count: number, text: string) => counted(count, text, 'byte', 'bytes'),
    tiles: (count: number, text: string) => counted(count, text, 'tile', 'tiles'),
    pictures: (count: number, text: string) => counted(count, text, 'picture', 'pictures'),
  },
  gallery: {
    onePiece: 'one piece, without an outline',
    noOutline: (why: string) => `No outline: ${why}`,
    emptyFolder: (folder: string) => `There are no hierarchies in ${folder} yet. Hierarchies that "meshhier build" puts there appear here.`,
    emptyFolderWithInbox: (folder: string, inbox: string) =>
      `There are no hierarchies in ${folder} yet. Mesh files that are put into ${inbox} become some.`,
    emptyListing: (listing: string) => `The listing ${listing} is empty.`,
    nothingToShow: (why: string) => `There are no models to show: ${why}.`,
    howToList:
      'Put a file models.json beside this page, {"models": [{"path": "NAME.hier"}]}, or let "meshhier serve" do it, ' +
      'or name a hierarchy in the address: ?model=NAME.hier',
  },
  listing: {
    notJson: (url: string) => `${url} is not JSON`,
    noModels: (url: string) => `${url} has no list "models"`,
    unreachable: (url: string) => `${url} cannot be reached`,
    namelessMesh: 'a mesh without a name',
  },
  jobs: {
    failed: 'failed, without saying why',
    waiting: 'waiting for its turn',
    building: 'building',
    progress: (name: string) => `${name}: progress`,
    left: (what: string, time: string) => `${what}, ${time} left`,
    stages: {
      import: 'reading the mesh',
      resume: 'going on where it stopped',
      ingest: 'measuring',
      images: 'reading pictures',
      partition: 'dividing',
      leaves: 'making the finest tiles',
      simplify: 'simplifying',
      texture: 'painting tiles',
      outline: 'drawing the outline',
      publish: 'writing tiles',
      pack: 'packing',
      sync: 'saving',
    },
  },
  problems: {
    noWebGl:
      'This browser has no WebGL 2, which the page draws with. Another browser may have it, or this one with its graphics acceleration on.',
    noCode: "the page's code could not be fetched",
    unfetchable: (path: string) => `The link names "${path}", which cannot be fetched.`,
    notShown: (model: string, why: string) => `${model} cannot be shown: ${why}.`,
    notOpened: (model: string, why: string) => `${model} cannot be opened: ${why}`,
    notAHierarchy: (url: string) =>
      `. Is ${url} a hierarchy made by "meshhier build"? "meshhier verify" says what is wrong with one`,
    pictureLost: 'The graphics card gave the picture up. It comes back as soon as the browser allows; else load the page again.',
    missing: (model: string, why: string) => `${model}: ${why}. The view goes on with what it has.`,
    missingFiles: (model: string, why: string, files: string) =>
      `${model}: ${why}. ${files} files are missing in all. The view goes on with what it has.`,
    badModel: (value: string) =>
      `?model=${value} is no address that can be fetched. It must be relative to this page, or start with http or https, and have no query or fragment.`,
    badListing: (value: string) =>
      `?models=${value} is no address that can be fetched. It must be relative to this page, or start with http or https.`,
  },
  view: {
    surface: (model: string) => `${model} in three dimensions. Arrows turn, plus and minus zoom, question mark helps.`,
    back: 'Back',
    whole: 'Whole model',
    tools: 'Tools',
    closer: 'Closer',
    farther: 'Farther',
    settings: 'Look and settings',
    figures: 'Figures',
    help: 'Help',
  },
  settings: {
    colours: 'Colours',
    colourNames: { plain: 'Plain', vertex: 'Input', partition: 'Partitions', error: 'Error' },
    texture: 'Texture',
    wires: 'Wires',
    points: 'Points',
    outline: 'Outline',
    flat: 'Flat',
    frameRate: 'Frame rate to hold',
    frameRateUnit: 'fps',
    threshold: 'Error allowed',
    pixels: 'px',
    memory: 'Memory',
    megabytes: 'MB',
    theme: 'Theme',
  },
  figures: {
    source: (file: string, vertices: string, triangles: string) => `${file}: ${vertices} and ${triangles}.`,
    missingPictures: (pictures: string, missing: string) => `${pictures}, ${missing} of them missing`,
    of: (part: string, whole: string) => `${part} of ${whole}`,
    atMost: (text: string) => `at most ${text}`,
    level: (tiles: string, level: number) => `${tiles}, level ${level}`,
    levels: (tiles: string, coarsest: number, finest: number) => `${tiles}, levels ${coarsest} to ${finest}`,
    dropped: (tiles: string, dropped: string) => `${tiles}, ${dropped} dropped`,
    onTheWay: (pending: string, aborted: string, failed: string) => `${pending}, ${aborted} given up, ${failed} failed`,
    /// Of each row its name, and a tip that says more.
    rows: {
      rate: ['Frames per second', 'while the camera moves, and the goal'],
      triangles: ['Triangles', 'in view'],
      vertices: ['Vertices', 'in view'],
      vertexBudget: ['Vertices in motion', 'the most that the frame rate allows'],
      tiles: ['Tiles', 'in view'],
      error: ['Largest error', 'on screen, of what is shown'],
      fetched: ['Fetched', 'bytes of tiles, and their number'],
      saved: ['Saved', 'against sending each view whole'],
      hits: ['Hits', 'tiles of views that were there already'],
      decoding: ['Decoding', 'of all tiles together'],
      memory: ['Memory', 'of tiles, and the budget'],
      peak: ['Most memory', 'of tiles so far'],
      resident: ['In memory', 'tiles, and those that made room for others'],
      pending: ['On their way', 'files asked for; given up because the view went elsewhere; failed'],
    },
  },
  help: {
    /// What hands or keys do, and what comes of it.
    hands: [
      ['Drag', 'turn'],
      ['Right drag, Shift + drag, two fingers', 'move'],
      ['Wheel, pinch', 'closer, farther, to where the pointer is'],
      ['Double click, double tap', 'fly there'],
    ],
    keys: [
      ['Arrows', 'turn'],
      ['Shift + arrows', 'move'],
      ['+ −', 'closer, farther'],
      ['Home, 0', 'the whole model'],
      ['Esc, Backspace', 'back'],
      ['1 2 3 4', "colours: plain, the input's, partitions, error"],
      ['T W P O F', 'texture, wires, points, outline, flat shading'],
      ['L', 'look and settings'],
      ['S', 'figures'],
      ['I M X', 'tools: pick a point, measure, cut open'],
      ['Enter, V, Backspace', 'in a tool: take the middle of the picture, snap to vertices, a step back'],
      ['?', 'this help'],
    ],
    /// What the modes are called in the literature.
    modesTitle: 'Modes',
    modes: [
      ['TP', 'thumbnail preview: the gallery'],
      ['CWV', 'coarse whole view: all of the model is in the picture'],
      ['ZSV', 'zoomed sector view: a part of it, refined'],
      ['DZM', 'deep zoom of the mesh: the original triangles'],
    ],
  },
};

export type Words = typeof en;
