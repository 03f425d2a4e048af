// Bindings copy the statistics by offset, so the class's struct must match Intel's byte for byte, with each count at the same
// offset.
#define ENABLE_STATS 1
#include "check.h"

#include "MaskedOcclusionCulling.h"

#include <limits>

namespace
{

typedef MaskedOcclusionCulling MOC;

// As a binding declares it.
struct Copied
{
    long long processed, rasterized, traversed, updated, merged;
    long long rectangles, tested, tested_rasterized, tested_traversed;
};

} // namespace

int main()
{
    static_assert(sizeof(Copied) == 72 && sizeof(MOC::OcclusionCullingStatistics) == 72 &&
                      offsetof(MOC::OcclusionCullingStatistics, mOccludees) == 40,
                  "nine counts, five of occluders first");
    MOC *moc = MOC::Create();
    moc->SetResolution(64, 64);
    float quad[16];
    quad_at(quad, -1, -1, 1, 1, 10);
    moc->RenderTriangles(quad, QUAD, 2);
    CHECK(moc->TestRect(-0.5f, -0.5f, 0.5f, 0.5f, 20) == MOC::OCCLUDED);
    quad_at(quad, -1, -1, 1, 1, 20);
    CHECK(moc->TestTriangles(quad, QUAD, 2) == MOC::OCCLUDED);
    quad[8] = std::numeric_limits<float>::quiet_NaN(); // of a vertex that both triangles share
    moc->RenderTriangles(quad, QUAD, 2);

    const MOC::OcclusionCullingStatistics stats = moc->GetStatistics();
    Copied copied;
    memcpy(&copied, &stats, sizeof(copied));
    CHECK_EQ(copied.processed, 4);
    CHECK_EQ(copied.rasterized, 2);
    CHECK_EQ(copied.rectangles, 1);
    CHECK_EQ(copied.tested, 2);
    CHECK_EQ(copied.tested_rasterized, 2);
    CHECK(copied.merged == stats.mOccluders.mNumTilesMerged);
    CHECK(copied.tested_traversed == stats.mOccludees.mNumTilesTraversed && copied.tested_traversed > 0);

    // The C struct has the same counts after its size.
    MOC_Statistics counted = {};
    counted.size = sizeof(counted);
    CHECK_EQ(MOC_GetStatistics(moc, &counted), MOC_STATUS_OK);
    CHECK(memcmp(&counted.occluders, &copied, sizeof(copied)) == 0);

    CHECK_EQ(moc->GetNumDroppedTriangles(), 2);
    MOC::Destroy(moc);
    return check_report("statistics_layout");
}
