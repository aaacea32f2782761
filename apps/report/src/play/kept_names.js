// Names in the browser's own file system (OPFS), for the page and for its worker.

export const kFolder = 'headpin';

/**
 * The file beside a log that says whether the log is whole up to where it ends: it has one byte, and none once the disk
 * did not take a piece. It is made with the log, as a full disk may have no room for another file.
 */
export const markOf = (name) => `${name}.mark`;
