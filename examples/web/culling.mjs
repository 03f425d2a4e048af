// The library from JavaScript, without bindings: the C functions of the .wasm file and its memory. This is an example to start
// from; engines compiled to WebAssembly link the library instead.

export const VISIBLE = 0, OCCLUDED = 1, VIEW_CULLED = 3;
export const SCALAR = -1, SIMD128 = 17;
const PAGE = 65536;

// Memory for JavaScript's own arrays. Pages added to a module's memory belong to the code that added them: the library's
// allocator uses only pages that it added itself. They are never freed, so allocate once and reuse.
class Arena {
    constructor(memory, bytes) {
        this.memory = memory;
        const pages = Math.ceil(bytes / PAGE);
        this.next = memory.grow(pages) * PAGE;
        this.end = this.next + pages * PAGE;
    }

    // An address aligned to 16.
    allocate(bytes) {
        const at = this.next;
        this.next += Math.ceil(bytes / 16) * 16;
        if (this.next > this.end) throw new RangeError('the arena is full');
        return at;
    }
}

export class Culling {
    // `module`: a WebAssembly.Module; `arenaBytes`: the size of all arrays together; `implementation`: the highest
    // instruction set allowed, by default what the module was compiled for.
    constructor(module, width, height, arenaBytes, implementation = SIMD128) {
        this.moc = new WebAssembly.Instance(module).exports;
        this.memory = this.moc.memory;
        this.arena = new Arena(this.memory, arenaBytes + 2 * PAGE);
        this.layout = this.arena.allocate(12);
        this.matrix = this.arena.allocate(64);
        this.out = this.arena.allocate(8);
        this.pixels = [width, height];
        const settings = this.arena.allocate(32);
        new Int32Array(this.memory.buffer, settings, 1)[0] = 32;
        this.check(this.moc.MOC_DefaultSettings(settings));
        new Int32Array(this.memory.buffer, settings, 2)[1] = implementation;
        this.check(this.moc.MOC_Create(settings, this.out));
        this.object = this.word(this.out);
        this.check(this.moc.MOC_SetResolution(this.object, width, height));
    }

    check(status) {
        if (status !== 0) throw new Error(`status ${status} (MOC_STATUS_ in masked_occlusion_culling.h)`);
    }

    // The memory's buffer is replaced when it grows, so views are created when they are needed.
    word(at) {
        return new Int32Array(this.memory.buffer, at, 1)[0];
    }

    implementation() {
        this.check(this.moc.MOC_GetImplementation(this.object, this.out));
        return this.word(this.out);
    }

    // A mesh of model-space positions (x, y, z packed), copied into the module's memory.
    mesh(positions, indices) {
        const vertices = this.arena.allocate(4 * positions.length);
        const triangles = this.arena.allocate(4 * indices.length);
        new Float32Array(this.memory.buffer, vertices, positions.length).set(positions);
        new Uint32Array(this.memory.buffer, triangles, indices.length).set(indices);
        return { vertices, floats: positions.length, triangles, count: indices.length / 3 };
    }

    #arguments(mesh, modelToClip) {
        new Float32Array(this.memory.buffer, this.matrix, 16).set(modelToClip);
        new Int32Array(this.memory.buffer, this.layout, 3).set([12, 4, 8]);
        const BACKFACE_CW = 1, CLIP_PLANE_ALL = 0x1f;
        return [this.object, mesh.vertices, mesh.floats, mesh.triangles, mesh.count, this.matrix, BACKFACE_CW,
            CLIP_PLANE_ALL, this.layout, this.out];
    }

    clear() {
        this.check(this.moc.MOC_ClearBuffer(this.object));
    }

    // `modelToClip`: 16 floats, column by column.
    render(mesh, modelToClip) {
        this.check(this.moc.MOC_RenderTrianglesChecked(...this.#arguments(mesh, modelToClip)));
        return this.word(this.out);
    }

    test(mesh, modelToClip) {
        this.check(this.moc.MOC_TestTrianglesChecked(...this.#arguments(mesh, modelToClip)));
        return this.word(this.out);
    }

    // Normalised device coordinates, and the smallest w.
    testRect(xmin, ymin, xmax, ymax, wmin) {
        this.check(this.moc.MOC_TestRect(this.object, xmin, ymin, xmax, ymax, wmin, this.out));
        return this.word(this.out);
    }

    // 1/w of every pixel, -1 where nothing was drawn, as the bits of floats: a view of memory that the next call overwrites.
    depth() {
        const count = this.pixels[0] * this.pixels[1];
        this.depthAt ??= this.arena.allocate(4 * count);
        this.check(this.moc.MOC_ComputePixelDepthBufferChecked(this.object, this.depthAt, count, 0));
        return new Uint32Array(this.memory.buffer, this.depthAt, count);
    }

    destroy() {
        this.check(this.moc.MOC_Destroy(this.object));
    }
}
