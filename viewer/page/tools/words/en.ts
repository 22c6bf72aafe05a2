// The tools' words in English; they come with the tools. Every other table has the same keys: `ToolWords` sees to it.

export const en = {
  title: 'Tools',
  close: (name: string) => `Close ${name.toLowerCase()}`,
  names: { pick: 'Pick a point', measure: 'Measure' },
  pick: {
    hint: 'Click or tap the surface; Enter takes the middle of the picture.',
    snap: 'Snap to vertices',
    copy: 'Copy',
    copied: 'Copied',
    notCopied: 'The browser does not allow it',
    normal: 'Normal',
    longitude: 'Longitude',
    latitude: 'Latitude',
    height: 'Height',
    from: 'From',
    original: (partition: string) => `the original, partition ${partition}`,
    level: (level: string) => `level ${level}, simplified`,
    refining: (from: string) => `${from}; asking for the original…`,
    exact: 'A vertex of the input, exact to the bit',
    notThere: 'The original could not be fetched; this is the surface as it is shown.',
  },
  measure: {
    hint: 'Click or tap points of the surface. Backspace takes the last one back.',
    clear: 'Clear',
    length: 'Length',
    level: 'In plan',
    straight: 'Straight',
    rise: 'Height',
    points: 'Points',
  },
  units: { model: 'The model is in', shown: 'Show', unknown: 'units (not known)', asModel: 'the same', unit: 'units' },
  scale: (length: string) => `${length} at the distance of what the camera looks at`,
};

export type ToolWords = typeof en;
