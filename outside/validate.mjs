// Whether Khronos' glTF-Validator finds errors or warnings in the GLB files of a folder.
//
//     node outside/validate.mjs FOLDER|FILE.glb ...

import { readFileSync } from 'node:fs';
import { filesOf, load } from './modules.mjs';

const validator = await load('gltf-validator/index.js');
let faults = 0;
const files = filesOf(process.argv.slice(2)).filter((file) => file.endsWith('.glb'));
for (const file of files) {
  const { issues, info } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  // 0 is an error, 1 a warning; what is less says, for instance, that nobody uses a texture coordinate.
  for (const message of issues.messages.filter((message) => message.severity <= 1)) {
    faults += 1;
    console.log(`FAILED  ${file}: ${message.code} at ${message.pointer}: ${message.message}`);
  }
  if (issues.truncated || issues.numErrors + issues.numWarnings > 0 || info.generator !== 'jbt') {
    faults += 1;
    console.log(`FAILED  ${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, by ${info.generator}`);
  }
}
console.log(`${files.length} files, ${faults} faults, glTF-Validator ${validator.version()}`);
process.exit(faults > 0 || files.length === 0 ? 1 : 0);
