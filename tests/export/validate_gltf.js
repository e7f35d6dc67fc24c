// Khronos' validator on one file: prints its report. Exit code 77 where it is not installed
// (npm install -g gltf-validator).
const fs = require('fs');
let validator;
try {
  validator = require('gltf-validator');
} catch {
  process.exit(77);
}
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])), {maxIssues: 0})
    .then(report => console.log(JSON.stringify(report)));
