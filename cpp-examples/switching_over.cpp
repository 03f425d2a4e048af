// An engine that uses Intel's MaskedOcclusionCulling: its own allocator, model matrices, its own vertex struct, and the
// switches of the original header. Nothing here is new; to switch, change only the include path and the library to
// link.

// QUICK_MASK chose one of two update rules when the original was compiled; it still does, per program. Leave it out for
// this library's default, which culls more.
#define QUICK_MASK 1
#include "MaskedOcclusionCulling.h"

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace engine {

static int liveAllocations = 0;

// The pointer from malloc is stored just in front of the aligned block.
void *AlignedAlloc(size_t alignment, size_t size) {
    void *block = std::malloc(size + alignment + sizeof(void *));
    if (!block) return nullptr;
    const size_t first = reinterpret_cast<size_t>(block) + sizeof(void *);
    const size_t aligned = (first + alignment - 1) / alignment * alignment;
    reinterpret_cast<void **>(aligned)[-1] = block;
    ++liveAllocations;
    return reinterpret_cast<void *>(aligned);
}

void AlignedFree(void *memory) {
    if (!memory) return;
    std::free(reinterpret_cast<void **>(memory)[-1]);
    --liveAllocations;
}

struct Vertex {
    float normal[3];
    float position[3];
    float uv[2];
};

struct Mesh {
    std::vector<Vertex> vertices;
    std::vector<unsigned int> indices;
};

// The pointer is to the first x. With a matrix the third offset is that of z.
MaskedOcclusionCulling::CullingResult Draw(MaskedOcclusionCulling *moc, const Mesh &mesh, const float *modelToClip) {
    const MaskedOcclusionCulling::VertexLayout layout(sizeof(Vertex), 4, 8);
    return moc->RenderTriangles(mesh.vertices[0].position, mesh.indices.data(), int(mesh.indices.size() / 3),
                                modelToClip, MaskedOcclusionCulling::BACKFACE_CW,
                                MaskedOcclusionCulling::CLIP_PLANE_ALL, layout);
}

}  // namespace engine

int main() {
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create(MaskedOcclusionCulling::AVX2, engine::AlignedAlloc,
                                                                 engine::AlignedFree);
    moc->SetResolution(1920, 1080);
    moc->SetNearClipPlane(0.5f);
    moc->ClearBuffer();

    // A wall 10 units in front of the eye, as a mesh of the engine.
    engine::Mesh wall;
    const float corners[4][2] = {{-6, -4}, {6, -4}, {6, 4}, {-6, 4}};
    for (const float *corner : corners) wall.vertices.push_back({{0, 0, 1}, {corner[0], corner[1], -10}, {0, 0}});
    wall.indices = {0, 1, 2, 0, 2, 3};

    // Column-major for column vectors (OpenGL), which has the same memory layout as row-major for row vectors
    // (Direct3D). Looks along -z, so w is -z. The third row is not used.
    const float modelToClip[16] = {
        1, 0, 0, 0,
        0, 1.78f, 0, 0,
        0, 0, 0, -1,
        0, 0, 0, 0,
    };
    const bool drawn = engine::Draw(moc, wall, modelToClip) == MaskedOcclusionCulling::VISIBLE;

    const bool hidden = moc->TestRect(-0.2f, -0.2f, 0.2f, 0.2f, 12.0f) == MaskedOcclusionCulling::OCCLUDED;
    const bool nearer = moc->TestRect(-0.2f, -0.2f, 0.2f, 0.2f, 9.0f) == MaskedOcclusionCulling::VISIBLE;

    std::vector<float> depth(1920 * 1080);
    moc->ComputePixelDepthBuffer(depth.data(), false);
    const float centre = depth[540 * 1920 + 960];

    MaskedOcclusionCulling::Destroy(moc);
    std::printf("wall drawn: %d, box behind it occluded: %d, box in front visible: %d, depth at the centre: %.4f\n",
                drawn, hidden, nearer, centre);
    std::printf("allocations left: %d\n", engine::liveAllocations);
    return drawn && hidden && nearer && engine::liveAllocations == 0 ? 0 : 1;
}
