// The tools' words in Spanish.
import type { ToolWords } from './en.js';

export const es: ToolWords = {
  title: 'Herramientas',
  close: (name) => `Cerrar ${name.toLowerCase()}`,
  names: { pick: 'Elegir un punto', measure: 'Medir' },
  pick: {
    hint: 'Haga clic o toque la superficie; Intro toma el centro de la imagen.',
    snap: 'Ajustar a los vértices',
    copy: 'Copiar',
    copied: 'Copiado',
    notCopied: 'El navegador no lo permite',
    normal: 'Normal',
    longitude: 'Longitud',
    latitude: 'Latitud',
    height: 'Altura',
    from: 'De',
    original: (partition) => `el original, partición ${partition}`,
    level: (level) => `nivel ${level}, simplificado`,
    refining: (from) => `${from}; se pide el original…`,
    exact: 'Un vértice de la entrada, exacto hasta el último bit',
    notThere: 'No se pudo obtener el original; esta es la superficie tal como se muestra.',
  },
  measure: {
    hint: 'Haga clic o toque puntos de la superficie. Retroceso quita el último.',
    clear: 'Vaciar',
    length: 'Longitud',
    level: 'En planta',
    straight: 'En línea recta',
    rise: 'Altura',
    points: 'Puntos',
  },
  units: { model: 'El modelo está en', shown: 'Mostrar en', unknown: 'unidades (sin saber cuáles)', asModel: 'las mismas', unit: 'unidades' },
  scale: (length) => `${length} a la distancia de lo que mira la cámara`,
};
