// The functions that `cargo tool scaling -- --other FILE` looks for in FILE, implemented with the class of any library:
// compile this with that library's header and link it into a shared object. C++11. docs/benchmarking.md has the
// commands.

// z lies where w does without a matrix, see below.
#define MOC_CHECK_LAYOUT 0
#include "MaskedOcclusionCulling.h"

#if defined(_WIN32)
#define SCALING_EXPORT extern "C" __declspec(dllexport)
#else
// Everything else is compiled with -fvisibility=hidden: two libraries with a class of this name are in one process.
#define SCALING_EXPORT extern "C" __attribute__((visibility("default")))
#endif

typedef MaskedOcclusionCulling Culling;

// Null if the class has no such instruction set. SSE2 is 0 and AVX512 is 3 in every version of the class, and a number
// that is not in the enumeration must not be converted to it.
SCALING_EXPORT Culling *scaling_create(int instructionSet) {
    if (instructionSet < Culling::SSE2 || instructionSet > Culling::AVX512) return nullptr;
    return Culling::Create(static_cast<Culling::Implementation>(instructionSet));
}

SCALING_EXPORT void scaling_destroy(Culling *culling) { Culling::Destroy(culling); }

// The one in use: it may be lower than requested.
SCALING_EXPORT int scaling_instruction_set(Culling *culling) { return culling->GetImplementation(); }

SCALING_EXPORT void scaling_set_resolution(Culling *culling, unsigned int width, unsigned int height) {
    culling->SetResolution(width, height);
}

SCALING_EXPORT void scaling_set_near(Culling *culling, float near_w) { culling->SetNearClipPlane(near_w); }

SCALING_EXPORT void scaling_clear(Culling *culling) { culling->ClearBuffer(); }

// Vertices of 16 bytes: x, y, four bytes of padding, z. This is the default layout, which a library is likely to be
// fast for: with a matrix its third offset is that of z, so z is where w is without one.
SCALING_EXPORT void scaling_render(Culling *culling, const float *vertices, const unsigned int *indices, int triangles,
                                 const float *modelToClip) {
    culling->RenderTriangles(vertices, indices, triangles, modelToClip);
}

SCALING_EXPORT int scaling_hides(Culling *culling, float xMin, float yMin, float xMax, float yMax, float wMin) {
    return culling->TestRect(xMin, yMin, xMax, yMax, wMin) == Culling::OCCLUDED;
}
