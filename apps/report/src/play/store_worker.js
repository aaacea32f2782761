// Writes a game's log into the browser's own file system, each piece to the disk at once.
let handle = null;
let at = 0;

async function open(name) {
  const root = await navigator.storage.getDirectory();
  const folder = await root.getDirectoryHandle('headpin', { create: true });
  const file = await folder.getFileHandle(name, { create: true });
  handle = await file.createSyncAccessHandle();
  at = handle.getSize();
}

function write(piece) {
  const written = handle.write(piece, { at });
  if (written !== piece.length) {
    handle.truncate(at);
    throw new Error(`${written} of ${piece.length} bytes were stored`);
  }
  at += written;
  handle.flush();
}

self.onmessage = async ({ data: { id, kind, name, piece } }) => {
  try {
    if (kind === 'open') await open(name);
    if (kind === 'write') write(piece);
    if (kind === 'close') handle.close();
    self.postMessage({ id, size: at });
  } catch (error) {
    self.postMessage({ id, error: `${error.name}: ${error.message}` });
  }
};
