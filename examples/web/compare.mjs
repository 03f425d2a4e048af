// node compare.mjs SCALAR.wasm SIMD128.wasm: draws a generated town with both modules, compares every pixel and every answer,
// checks that a box behind a wall is hidden and one in front of it is not, and times a frame.
import { readFileSync } from 'node:fs';
import { performance } from 'node:perf_hooks';
import { Culling, OCCLUDED, SCALAR, SIMD128, VISIBLE } from './culling.mjs';

const [WIDTH, HEIGHT] = [1280, 720];
const FRAMES = Number(process.env.FRAMES ?? 40);

// Pixels are compared bit by bit. They are -1.0 where nothing was drawn, otherwise finite and not negative.
const NOTHING = 0xbf800000;
const isDepth = bits => bits === NOTHING || bits < 0x7f800000;

function expect(truth, what) {
    if (!truth) throw new Error(what);
}

// A random generator with the same sequence everywhere.
let state = 12345;
const number = (low, high) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return low + (high - low) * (state >>> 8) / (1 << 24);
};

// A box, its faces counter-clockwise from outside.
function box([x0, y0, z0], [x1, y1, z1], into) {
    const first = into.positions.length / 3;
    for (let i = 0; i < 8; i++) into.positions.push(i & 1 ? x1 : x0, i & 2 ? y1 : y0, i & 4 ? z1 : z0);
    for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
        into.indices.push(...[a, b, c, a, c, d].map(i => first + i));
    return into;
}
const shape = () => ({ positions: [], indices: [] });

// Forty blocks of fifty houses, a hilly floor of 20,000 triangles, and small boxes to be tested.
const occluders = Array.from({ length: 40 }, () => {
    const block = shape();
    for (let i = 0; i < 50; i++) {
        const [x, z, size, tall] = [number(-120, 120), number(-250, -20), number(1, 4), number(-2, 5)];
        box([x, -3, z], [x + size, tall, z + size], block);
    }
    return block;
});
const floor = shape();
for (let k = 0; k <= 100; k++)
    for (let i = 0; i <= 100; i++) floor.positions.push(3 * i - 150, number(-4, -3), -3 * k);
for (let k = 0; k < 100; k++)
    for (let i = 0; i < 100; i++) {
        const a = 101 * k + i;
        floor.indices.push(a, a + 1, a + 102, a, a + 102, a + 101);
    }
occluders.push(floor);
const occludees = Array.from({ length: 1000 }, () => {
    const at = [number(-120, 120), number(-3, 12), number(-250, -8)];
    return box(at, at.map(x => x + 1), shape());
});
// Looks along -z; w is -z.
const matrix = [1, 0, 0, 0, 0, 16 / 9, 0, 0, 0, 0, -1, -1, 0, 0, -0.2, 0];

// One frame: everything drawn, then every occludee tested.
function frame(culling, meshes, tested) {
    const answers = [];
    culling.clear();
    for (const mesh of meshes) answers.push(culling.render(mesh, matrix));
    for (const mesh of tested) answers.push(culling.test(mesh, matrix));
    return answers;
}

function open(path, highest) {
    const module = new WebAssembly.Module(readFileSync(path));
    expect(WebAssembly.Module.imports(module).length === 0, `${path} needs imports`);
    const culling = new Culling(module, WIDTH, HEIGHT, 16 << 20, highest);
    const [meshes, tested] = [occluders, occludees].map(all => all.map(o => culling.mesh(o.positions, o.indices)));
    return { culling, meshes, tested, times: [] };
}

const scalar = open(process.argv[2], SIMD128);
const simd128 = open(process.argv[3], SIMD128);
expect(scalar.culling.implementation() === SCALAR, 'a module without simd128 is scalar');
expect(simd128.culling.implementation() === SIMD128, 'a module with simd128 uses it');

// Every pixel has the same bits, and the answers are the same.
const [answers, others] = [scalar, simd128].map(m => frame(m.culling, m.meshes, m.tested));
expect(`${answers}` === `${others}`, 'answers differ');
const [pixels, more] = [scalar, simd128].map(m => m.culling.depth());
expect(pixels.every((bits, i) => bits === more[i]), 'pixels differ');
const covered = pixels.filter(bits => bits !== NOTHING).length;
const tests = answers.slice(occluders.length);
const share = answer => tests.filter(a => a === answer).length;
expect(covered > pixels.length / 4 && share(OCCLUDED) > 100 && share(VISIBLE) > 10, 'the scene shows nothing');
expect(pixels.every(isDepth), 'a depth is no number');

// NaN, infinity and garbage in vertices and indices: refused or dropped, with the same bits, and no NaN or infinity in the
// buffer.
const garbage = [scalar, simd128].map(({ culling }) => {
    state = 777;
    const positions = Float32Array.from({ length: 3000 }, () => number(-20, 20));
    const words = new Uint32Array(positions.buffer);
    for (let i = 0; i < 600; i++) {
        // Arbitrary bit patterns, including NaNs with any payload.
        const at = Math.floor(number(0, 3000));
        words[at] = i % 3 ? (Math.floor(number(0, 65536)) * 65536 + Math.floor(number(0, 65536))) >>> 0
            : (0x7f800000 + Math.floor(number(0, 1 << 23)) + (i % 2) * 0x80000000) >>> 0;
    }
    const mesh = culling.mesh([], []);
    const [v, t] = [culling.arena.allocate(12000), culling.arena.allocate(12000)];
    new Uint32Array(culling.memory.buffer, v, 3000).set(words);
    new Uint32Array(culling.memory.buffer, t, 3000).set(Uint32Array.from({ length: 3000 }, () => Math.floor(number(0, 1000))));
    Object.assign(mesh, { vertices: v, floats: 3000, triangles: t, count: 1000 });
    culling.clear();
    const answers = [culling.render(mesh, matrix), culling.test(mesh, matrix)];
    new Uint32Array(culling.memory.buffer, t, 1)[0] = 1000;
    try {
        culling.render(mesh, matrix);
        answers.push('taken');
    } catch {
        answers.push('refused');
    }
    return { answers, pixels: culling.depth().slice() };
});
expect(`${garbage[0].answers}` === `${garbage[1].answers}`, 'answers about garbage differ');
expect(garbage[0].answers[2] === 'refused', 'an index out of range was taken');
expect(garbage[0].pixels.every((bits, i) => bits === garbage[1].pixels[i]), 'pixels of garbage differ');
expect(garbage[0].pixels.every(isDepth), 'garbage reached the buffer');
expect(garbage[0].pixels.some(bits => bits !== NOTHING), 'of the garbage nothing was drawn');

// What a wall hides, in a buffer of its own.
const wall = simd128.culling.mesh([-9, -9, -10, 9, -9, -10, 9, 9, -10, -9, 9, -10], [0, 1, 2, 0, 2, 3]);
simd128.culling.clear();
simd128.culling.render(wall, matrix);
expect(simd128.culling.testRect(-0.1, -0.1, 0.1, 0.1, 12) === OCCLUDED, 'behind the wall');
expect(simd128.culling.testRect(-0.1, -0.1, 0.1, 0.1, 8) === VISIBLE, 'before the wall');

// A pool without worker threads: the flushing call draws. A pool with threads is refused.
{
    const { moc, out, object, matrix: modelToClip, layout } = simd128.culling;
    const check = status => simd128.culling.check(status);
    const OUT_OF_MEMORY = 10, BACKFACE_CW = 1, CLIP_PLANE_ALL = 0x1f;
    expect(moc.MOC_ThreadpoolCreate(2, 2, 2, 8, 0, out) === OUT_OF_MEMORY, 'there are no threads');
    check(moc.MOC_ThreadpoolCreate(0, 2, 2, 8, 0, out));
    const pool = simd128.culling.word(out);
    const hidden = () => {
        check(moc.MOC_ThreadpoolFlush(pool));
        check(moc.MOC_ThreadpoolTestRect(pool, -0.1, -0.1, 0.1, 0.1, 12, out));
        return simd128.culling.word(out) === OCCLUDED;
    };
    check(moc.MOC_ThreadpoolSetBuffer(pool, object));
    check(moc.MOC_ThreadpoolSetMatrix(pool, modelToClip));
    check(moc.MOC_ThreadpoolSetVertexLayout(pool, layout));
    check(moc.MOC_ThreadpoolWakeThreads(pool));
    check(moc.MOC_ThreadpoolClearBuffer(pool));
    expect(!hidden(), 'the pool cleared');
    check(moc.MOC_ThreadpoolRenderTriangles(pool, wall.vertices, wall.triangles, wall.count, BACKFACE_CW, CLIP_PLANE_ALL));
    expect(hidden(), 'the pool drew');
    check(moc.MOC_ThreadpoolSuspendThreads(pool));
    check(moc.MOC_ThreadpoolDestroy(pool));
}

// Alternating, so that both run under the same conditions.
for (let i = 0; i < FRAMES; i++)
    for (const m of [scalar, simd128]) {
        const begin = performance.now();
        frame(m.culling, m.meshes, m.tested);
        m.times.push(performance.now() - begin);
    }
const [a, b] = [scalar, simd128].map(m => m.times.sort((x, y) => x - y));
const tell = (what, k) => `${what}: scalar ${a[k].toFixed(2)} ms, simd128 ${b[k].toFixed(2)} ms, ratio ${(a[k] / b[k]).toFixed(2)}`;
console.log(`${covered} of ${pixels.length} pixels covered; of ${tests.length} boxes ${share(OCCLUDED)} hidden, ` +
    `${share(VISIBLE)} visible; no pixel and no answer differs`);
if (FRAMES > 0) console.log(`of ${FRAMES} frames ${tell('the fastest', 0)}; ${tell('the median', FRAMES >> 1)}`);
for (const m of [scalar, simd128]) m.culling.destroy();
