// The functions that `cargo run --example growth -- --other FILE` looks for in FILE, over the class of whatever
// library: compile this with that library's header and link it into a shared object. C++11. docs/benchmarking.md has
// the commands.

#include "MaskedOcclusionCulling.h"

#if defined(_WIN32)
#define GROWTH_EXPORT extern "C" __declspec(dllexport)
#else
// The rest is compiled with -fvisibility=hidden: two libraries with a class of this name are in one process.
#define GROWTH_EXPORT extern "C" __attribute__((visibility("default")))
#endif

typedef MaskedOcclusionCulling Culling;

// Null where the class has no such instruction set. SSE2 is 0 and AVX512 is 3 in every version of the class, and
// a number that an enumeration does not have must not become one.
GROWTH_EXPORT Culling *growth_create(int instructionSet) {
    if (instructionSet < Culling::SSE2 || instructionSet > Culling::AVX512) return nullptr;
    return Culling::Create(static_cast<Culling::Implementation>(instructionSet));
}

GROWTH_EXPORT void growth_destroy(Culling *culling) { Culling::Destroy(culling); }

// The one in use: it may be less than what was asked for.
GROWTH_EXPORT int growth_instruction_set(Culling *culling) { return culling->GetImplementation(); }

GROWTH_EXPORT void growth_set_resolution(Culling *culling, unsigned int width, unsigned int height) {
    culling->SetResolution(width, height);
}

GROWTH_EXPORT void growth_set_near(Culling *culling, float near_w) { culling->SetNearClipPlane(near_w); }

GROWTH_EXPORT void growth_clear(Culling *culling) { culling->ClearBuffer(); }

// Vertices of 16 bytes: x, y, four bytes of anything, z. This is the default layout, for which a library is likely to
// be made fast: with a matrix its third offset names z, so that z lies where w does without one.
GROWTH_EXPORT void growth_render(Culling *culling, const float *vertices, const unsigned int *indices, int triangles,
                                 const float *modelToClip) {
    culling->RenderTriangles(vertices, indices, triangles, modelToClip);
}

GROWTH_EXPORT int growth_hides(Culling *culling, float xMin, float yMin, float xMax, float yMax, float wMin) {
    return culling->TestRect(xMin, yMin, xMax, yMax, wMin) == Culling::OCCLUDED;
}
