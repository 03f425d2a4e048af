// The exact counts of the statistics: triangles drawn, binned, drawn from lists and tested.
#define ENABLE_STATS 1
#include "check.h"

#include "MaskedOcclusionCulling.h"

#include <limits>
#include <vector>

namespace
{

typedef MaskedOcclusionCulling MOC;

// Two columns and eight rows of tiles.
const unsigned int WIDTH = 64, HEIGHT = 64;

void Occluders(MOC *moc)
{
    float wall[16];
    quad_at(wall, -1, -1, 1, 1, 10);
    CHECK(moc->RenderTriangles(wall, QUAD, 2) == MOC::VISIBLE);
    MOC::OcclusionCullingStatistics stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccluders.mNumProcessedTriangles, 2);
    CHECK_EQ(stats.mOccluders.mNumRasterizedTriangles, 2);
    CHECK_EQ(stats.mOccluders.mNumTilesTraversed, 2 * 16); // the bounds of each half are the screen
    CHECK_EQ(stats.mOccluders.mNumTilesUpdated, 2 * 12);   // each half is in all tiles but four

    // Binned, both into both bins: nothing is traversed.
    std::vector<float> left(9 * 4), right(9 * 4);
    MOC::TriList lists[2] = {{4, 0, left.data()}, {4, 0, right.data()}};
    moc->BinTriangles(wall, QUAD, 2, lists, 2, 1);
    CHECK_EQ(lists[0].mTriIdx, 2);
    CHECK_EQ(lists[1].mTriIdx, 2);
    stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccluders.mNumProcessedTriangles, 2 + 2);
    CHECK_EQ(stats.mOccluders.mNumRasterizedTriangles, 2 + 2);
    CHECK_EQ(stats.mOccluders.mNumTilesTraversed, 32);

    // The lists: two triangles each, in eight tiles each.
    moc->ClearBuffer();
    const MOC::ScissorRect halves[2] = {MOC::ScissorRect(0, 0, 32, 64), MOC::ScissorRect(32, 0, 64, 64)};
    moc->RenderTrilist(lists[0], &halves[0]);
    moc->RenderTrilist(lists[1], &halves[1]);
    stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccluders.mNumProcessedTriangles, 2 + 2 + 4);
    CHECK_EQ(stats.mOccluders.mNumRasterizedTriangles, 2 + 2 + 4);
    CHECK_EQ(stats.mOccluders.mNumTilesTraversed, 32 + 4 * 8);
    CHECK_EQ(stats.mOccluders.mNumTilesUpdated, 24 + 24);
    CHECK_EQ(moc->GetNumDroppedTriangles(), 0);

    // A rejected rectangle counts nothing.
    const MOC::ScissorRect odd(1, 0, 32, 64);
    moc->RenderTrilist(lists[0], &odd);
    CHECK_EQ(moc->GetStatistics().mOccluders.mNumProcessedTriangles, 8);

    // Submitted, but back-facing, off screen, or NaN.
    const unsigned int back[3] = {0, 2, 1};
    CHECK(moc->RenderTriangles(wall, back, 1) == MOC::VIEW_CULLED);
    float outside[16];
    quad_at(outside, 2, 2, 3, 3, 10);
    CHECK(moc->RenderTriangles(outside, QUAD, 2) == MOC::VIEW_CULLED);
    float broken[16];
    quad_at(broken, -1, -1, 1, 1, 10);
    broken[8] = std::numeric_limits<float>::quiet_NaN(); // in a corner of both triangles
    moc->RenderTriangles(broken, QUAD, 2);
    stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccluders.mNumProcessedTriangles, 8 + 1 + 2 + 2);
    CHECK_EQ(stats.mOccluders.mNumRasterizedTriangles, 8);
    CHECK_EQ(stats.mOccluders.mNumTilesTraversed, 64);
    CHECK_EQ(moc->GetNumDroppedTriangles(), 2);
}

void Occludees(MOC *moc)
{
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, 20);
    CHECK(moc->TestTriangles(quad, QUAD, 2) == MOC::OCCLUDED);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20) == MOC::OCCLUDED);
    MOC::OcclusionCullingStatistics stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccludees.mNumProcessedRectangles, 1);
    CHECK_EQ(stats.mOccludees.mNumProcessedTriangles, 2);
    CHECK_EQ(stats.mOccludees.mNumRasterizedTriangles, 2);
    CHECK_EQ(stats.mOccludees.mNumTilesTraversed, 2 * 16); // the bounds of each half are the screen

    // The first triangle is visible, in the first tile: the second only counts as submitted.
    quad_at(quad, -1, -1, 1, 1, 5);
    const unsigned int top_left_first[6] = {0, 2, 3, 0, 1, 2};
    CHECK(moc->TestTriangles(quad, top_left_first, 2) == MOC::VISIBLE);
    stats = moc->GetStatistics();
    CHECK_EQ(stats.mOccludees.mNumProcessedTriangles, 2 + 2);
    CHECK_EQ(stats.mOccludees.mNumRasterizedTriangles, 2 + 1);
    CHECK_EQ(stats.mOccludees.mNumTilesTraversed, 32 + 16);

    // So is one at the depth of the wall.
    quad_at(quad, -1, -1, 1, 1, 10);
    CHECK(moc->TestTriangles(quad, QUAD, 2) == MOC::VISIBLE);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 10) == MOC::VISIBLE);

    // Rectangles off screen, empty, or without a distance.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(moc->TestRect(1.5f, -0.5f, 2.0f, 0.5f, 20) == MOC::VIEW_CULLED);
    CHECK(moc->TestRect(0.5f, -0.5f, -0.5f, 0.5f, 20) == MOC::VISIBLE);
    CHECK(moc->TestRect(-0.5f, nan, 0.5f, 0.5f, 20) == MOC::VISIBLE);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, nan) == MOC::VISIBLE);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 0) == MOC::VISIBLE);
    CHECK_EQ(moc->GetStatistics().mOccludees.mNumProcessedRectangles, 7);
}

} // namespace

int main()
{
    const MOC::Implementation all[] = {MOC::SCALAR, MOC::SSE2, MOC::SSE41, MOC::AVX2, MOC::AVX512};
    for (MOC::Implementation implementation : all) {
        MOC *moc = MOC::Create(implementation);
        CHECK(moc != nullptr);
        moc->SetResolution(WIDTH, HEIGHT);
        Occluders(moc);
        Occludees(moc);
        MOC::Destroy(moc);
    }
    return check_report("statistics");
}
