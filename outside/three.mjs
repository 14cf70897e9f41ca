// Whether the loaders of three.js read the files of a folder as they are meant.
//
//     node outside/three.mjs FOLDER
//
// The folder is one of `files.py --keep`, whose expected.json says what the files show: bounds, the axis that is up, a colour.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { load } from './modules.mjs';

// GLTFLoader looks for a browser.
globalThis.self = globalThis;
const THREE = await load('three/build/three.module.js');
const { GLTFLoader } = await load('three/examples/jsm/loaders/GLTFLoader.js');
const { OBJLoader } = await load('three/examples/jsm/loaders/OBJLoader.js');
const { PLYLoader } = await load('three/examples/jsm/loaders/PLYLoader.js');
const { STLLoader } = await load('three/examples/jsm/loaders/STLLoader.js');

const loaders = {
  glb: async (bytes) => (await new GLTFLoader().parseAsync(bytes, '')).scene,
  obj: async (bytes) => new OBJLoader().parse(new TextDecoder().decode(bytes)),
  ply: async (bytes) => new THREE.Mesh(new PLYLoader().parse(bytes)),
  stl: async (bytes) => new THREE.Mesh(new STLLoader().parse(bytes)),
};

let faults = 0;
function check(fine, file, what) {
  if (!fine) {
    faults += 1;
    console.log(`FAILED  ${file}: ${what}`);
  }
}

const near = (found, expected, tolerance) =>
  found.length === expected.length && found.every((x, index) => Math.abs(x - expected[index]) <= tolerance);

/** Where the bounds of a model are in a file. */
function turned([x0, y0, z0, x1, y1, z1], up) {
  return up === 'y' ? [x0, z0, -y1, x1, z1, -y0] : [x0, y0, z0, x1, y1, z1];
}

const folder = process.argv[2];
const expected = JSON.parse(readFileSync(join(folder, 'expected.json')));
for (const [file, { bounds, up, color }] of Object.entries(expected)) {
  const bytes = new Uint8Array(readFileSync(join(folder, file))).buffer;
  const ending = file.split('.').pop();
  const root = await loaders[ending](bytes);
  root.updateMatrixWorld(true);
  const box = new THREE.Box3().setFromObject(root, true);
  const found = [...box.min.toArray(), ...box.max.toArray()];
  const size = Math.max(...bounds.map(Math.abs));
  check(near(found, turned(bounds, up), 1e-6 * size), file, `bounds ${found}, expected ${turned(bounds, up)}`);
  root.traverse((object) => {
    if (!object.isMesh || color === null || ending === 'stl') return;
    const colors = object.geometry.getAttribute('color');
    check(colors !== undefined, file, 'no colours');
    // three.js works in linear light. Bytes for screens are up to 1/2 off, which is 0.0045 of linear light where it is most.
    for (let vertex = 0; vertex < (colors?.count ?? 0); vertex++) {
      const channels = [colors.getX(vertex), colors.getY(vertex), colors.getZ(vertex)];
      if (!near(channels, color, ending === 'ply' ? 0.0045 : 1e-6)) {
        check(false, file, `vertex ${vertex} is ${channels}, expected ${color}`);
        break;
      }
    }
    // PLY and STL come as geometry alone, which whoever loads it gives a material.
    if (ending !== 'ply') check(object.material.vertexColors, file, 'the material hides the colours');
  });
}
console.log(`${Object.keys(expected).length} files, ${faults} faults, three.js ${THREE.REVISION}`);
process.exit(faults > 0 || Object.keys(expected).length === 0 ? 1 : 0);
