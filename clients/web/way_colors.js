// The colours of the ways, which number the clusters from 1 (Okabe & Ito's palette for all eyes).

// The same as --way-0 ... in the style sheet.
export const WAY_COLORS = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9];

/** @param {number} cluster */
const indexOf = (cluster) => (cluster - 1) % WAY_COLORS.length;

/** @param {number} cluster */
export const wayColor = (cluster) => WAY_COLORS[indexOf(cluster)];

/**
 * The class of elements in a way's colour.
 * @param {number} cluster
 */
export const wayClass = (cluster) => `way-${indexOf(cluster)}`;

/**
 * The variable of the style sheet that holds a way's colour.
 * @param {number} cluster
 */
export const wayVariable = (cluster) => `--way-${indexOf(cluster)}`;
