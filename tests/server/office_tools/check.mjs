// What Microsoft's own tools make of the add-in: the manifest as they read it, and the metadata they generate for
// functions declared as ours are. JSON on the output; the test compares.
//
//   node check.mjs MANIFEST FUNCTIONS
import { createRequire } from "node:module";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const require = createRequire(import.meta.url);
const { OfficeAddinManifest } = require("office-addin-manifest");
const { generateCustomFunctionsMetadata } = require("custom-functions-metadata");

/** A function as its author would declare it, from its metadata. */
function declared(one, k) {
  const { stream } = one.options;
  const invocation = stream ? "StreamingInvocation<any[][]>" : "Invocation";
  return [
    "/**",
    ` * ${one.description}`,
    ` * @customfunction ${one.id} ${one.name}`,
    ...one.parameters.map(p => ` * @param {any[][]} ${p.optional ? `[${p.name}]` : p.name} ${p.description}`),
    ` * @param {CustomFunctions.${invocation}} invocation`,
    stream ? " * @streaming" : " * @returns {any[][]}",
    " * @requiresParameterAddresses",
    " */",
    `function f${k}(${[...one.parameters.map(p => p.name), "invocation"].join(", ")}) {}`,
  ].join("\n");
}

const [manifest, functions] = process.argv.slice(2);
const ours = JSON.parse(readFileSync(functions, "utf8")).functions;
const folder = mkdtempSync(join(tmpdir(), "functions-"));
try {
  const source = join(folder, "functions.js");
  writeFileSync(source, ours.map(declared).join("\n\n"));
  const made = await generateCustomFunctionsMetadata([source]);
  const read = await OfficeAddinManifest.readManifestFile(manifest);
  console.log(JSON.stringify({ manifest: read, errors: made.errors, functions: JSON.parse(made.metadataJson).functions }));
} finally {
  rmSync(folder, { recursive: true });
}
