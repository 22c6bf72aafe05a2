// The tools' words in German.
import type { ToolWords } from './en.js';

export const de: ToolWords = {
  title: 'Werkzeuge',
  close: (name) => `${name} schließen`,
  names: { pick: 'Punkt wählen', measure: 'Messen' },
  pick: {
    hint: 'Klicken oder tippen Sie auf die Oberfläche; Enter nimmt die Mitte des Bildes.',
    snap: 'An Eckpunkten einrasten',
    copy: 'Kopieren',
    copied: 'Kopiert',
    notCopied: 'Der Browser erlaubt es nicht',
    normal: 'Normale',
    longitude: 'Länge',
    latitude: 'Breite',
    height: 'Höhe',
    from: 'Aus',
    original: (partition) => `dem Original, Partition ${partition}`,
    level: (level) => `Stufe ${level}, vereinfacht`,
    refining: (from) => `${from}; das Original wird geholt…`,
    exact: 'Ein Eckpunkt der Eingabe, auf das Bit genau',
    notThere: 'Das Original ließ sich nicht holen; dies ist die Oberfläche, wie sie gezeigt wird.',
  },
  measure: {
    hint: 'Klicken oder tippen Sie auf Punkte der Oberfläche. Die Rücktaste nimmt den letzten zurück.',
    clear: 'Leeren',
    length: 'Länge',
    level: 'Im Grundriss',
    straight: 'Luftlinie',
    rise: 'Höhe',
    points: 'Punkte',
  },
  units: { model: 'Das Modell ist in', shown: 'Zeigen in', unknown: 'Einheiten (unbekannt)', asModel: 'denselben', unit: 'Einheiten' },
  scale: (length) => `${length} in der Entfernung, auf die die Kamera blickt`,
};
