// One wall and six boxes through the conventions of OpenGL, Direct3D and Vulkan, and through every vertex layout: the
// same pixels and the same answers each time. docs/conventions.md quotes from here. The assertion on layouts is off,
// because the pitfall below is demonstrated.
#define MOC_CHECK_LAYOUT 0
#include "MaskedOcclusionCulling.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

typedef MaskedOcclusionCulling Moc;
typedef std::array<float, 16> Matrix;

// The camera is at the origin. kX and kY are the scales of x and y (1 / tan of half the angle; for x, divided by the
// aspect).
static const float kX = 0.5625f, kY = 1.0f, kNear = 0.5f, kFar = 100.0f;

// Column vectors, stored column by column. Right-handed, looks along -z, so w is -z. Depth from -1 to 1.
static Matrix OpenGl() {
    return {{
        kX, 0, 0, 0,
        0, kY, 0, 0,
        0, 0, (kFar + kNear) / (kNear - kFar), -1,
        0, 0, 2 * kFar * kNear / (kNear - kFar), 0,
    }};
}

// Row vectors, stored row by row. Left-handed, looks along +z, so w is z. Depth from 0 to 1.
static Matrix Direct3D() {
    return {{
        kX, 0, 0, 0,
        0, kY, 0, 0,
        0, 0, kFar / (kFar - kNear), 1,
        0, 0, -kFar * kNear / (kFar - kNear), 0,
    }};
}

// Right-handed like OpenGL's, but y points down in clip space, and depth runs from 0 to 1.
static Matrix Vulkan() {
    return {{
        kX, 0, 0, 0,
        0, -kY, 0, 0,
        0, 0, kFar / (kNear - kFar), -1,
        0, 0, kFar * kNear / (kNear - kFar), 0,
    }};
}

// Right-handed, without a far plane, depth reversed: 1 at the near plane, 0 infinitely far.
static Matrix ReversedInfinite() {
    return {{
        kX, 0, 0, 0,
        0, kY, 0, 0,
        0, 0, 0, -1,
        0, 0, kNear, 0,
    }};
}

// Flips y, for clip spaces in which it points down, as in Vulkan.
static Matrix TurnY(Matrix m) {
    for (int i : {1, 5, 9, 13}) m[i] = -m[i];
    return m;
}

// For column vectors stored row by row, and row vectors stored column by column.
static Matrix Transposed(const Matrix &m) {
    Matrix t;
    for (int i = 0; i < 16; ++i) t[i] = m[i % 4 * 4 + i / 4];
    return t;
}

// `first`, then `second`: first * second for row vectors, second * first for column vectors. The memory is the same.
static Matrix Product(const Matrix &first, const Matrix &second) {
    Matrix p = {{}};
    for (int i = 0; i < 16; ++i)
        for (int k = 0; k < 4; ++k) p[i] += first[i / 4 * 4 + k] * second[k * 4 + i % 4];
    return p;
}

// For meshes with counter-clockwise front faces. A mirroring model matrix reverses the winding.
static Moc::BackfaceWinding Backfaces(const Matrix &m) {
    const float determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
                              m[2] * (m[4] * m[9] - m[5] * m[8]);
    return determinant < 0 ? Moc::BACKFACE_CCW : Moc::BACKFACE_CW;
}

struct Box { float lo[3], hi[3]; };
struct Rect { float xmin, ymin, xmax, ymax, wmin; };
enum class Place { Outside, NearPlane, Rectangle };

// Rounded outwards, so that the rectangle contains the box.
static float Below(double v) { return std::nextafter(float(v), -FLT_MAX); }
static float Above(double v) { return std::nextafter(float(v), FLT_MAX); }

// Where a box is. Rectangle: r has the arguments of TestRect. NearPlane: the box crosses the near plane and may be in view, so
// no rectangle bounds it. Outside: all of it is nearer than the near plane, behind the eye, or beyond one side of the view.
static Place ProjectBox(const Matrix &m, const Box &box, float nearW, Rect &r) {
    int before = 0, behind = 0, left = 0, right = 0, below = 0, above = 0;
    r = {FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX, FLT_MAX};
    for (int corner = 0; corner < 8; ++corner) {
        // In double precision, so that rounding moves no corner to the other side of a plane.
        const double x = corner & 1 ? box.hi[0] : box.lo[0];
        const double y = corner & 2 ? box.hi[1] : box.lo[1];
        const double z = corner & 4 ? box.hi[2] : box.lo[2];
        const double cx = x * m[0] + y * m[4] + z * m[8] + m[12];
        const double cy = x * m[1] + y * m[5] + z * m[9] + m[13];
        const double w = x * m[3] + y * m[7] + z * m[11] + m[15];
        before += w >= nearW && w > 0, behind += w < nearW || w <= 0;
        left += cx < -w, right += cx > w, below += cy < -w, above += cy > w;
        r = {std::min(r.xmin, Below(cx / w)), std::min(r.ymin, Below(cy / w)), std::max(r.xmax, Above(cx / w)),
             std::max(r.ymax, Above(cy / w)), std::min(r.wmin, Below(w))};
    }
    if (behind == 8 || left == 8 || right == 8 || below == 8 || above == 8) return Place::Outside;
    return before == 8 ? Place::Rectangle : Place::NearPlane;
}

// The culling result for a box.
static Moc::CullingResult TestBox(const Moc *moc, const Matrix &m, const Box &box) {
    Rect r;
    switch (ProjectBox(m, box, moc->GetNearClipPlane(), r)) {
        case Place::Outside: return Moc::VIEW_CULLED;
        case Place::NearPlane: return Moc::VISIBLE;
        case Place::Rectangle: break;
    }
    return moc->TestRect(r.xmin, r.ymin, r.xmax, r.ymax, r.wmin);
}

// In an orthographic view w is the same everywhere, so it cannot serve as depth. With z from 0 (near) to 1 (far), this
// makes 2 - z the depth: linear on the screen, as depth is in such a view. Drawn and tested without a matrix.
static std::array<float, 4> FromOrthographic(float x, float y, float z) {
    const float w = 1 / (2 - z);
    return {{x * w, y * w, 0, w}};
}

static const int kWidth = 320, kHeight = 180;
static std::vector<float> reference;  // the pixels of the first convention
static std::string expected;          // and its results
static bool failed = false;

static std::string Text(Moc::CullingResult result) {
    return result == Moc::VISIBLE ? "visible" : result == Moc::OCCLUDED ? "occluded" : "outside";
}

static void Say(const std::string &what, bool right, const std::string &answer) {
    std::printf("%s: %s%s\n", what.c_str(), answer.c_str(), right ? "" : " (WRONG)");
    failed |= !right;
}

// The wall, above and to the left of the middle, 10 away: if y or x is mirrored by mistake, boxes become visible.
static const float kWall[4][2] = {{-8, 1}, {1, 1}, {1, 6}, {-8, 6}};
static const unsigned kCounterClockwise[6] = {0, 1, 2, 0, 2, 3}, kClockwise[6] = {0, 2, 1, 0, 3, 2};

// Boxes: x and y, and the distance from the eye.
static const Box kBoxes[6] = {
    {{-4, 2, 14}, {-2, 4, 15}},    // behind the wall
    {{-2, 1, 4}, {-1, 2, 5}},      // in front of it
    {{-4, -4, 14}, {-2, -2, 15}},  // below
    {{2, 2, 14}, {4, 4, 15}},      // to the right
    {{40, 2, 14}, {42, 4, 15}},    // outside the view
    {{-1, -1, 0.1f}, {1, 1, 20}},  // through the near plane
};

// Tests the boxes in a space viewed along +z (1) or -z (-1), and compares answers and pixels.
static void Check(const std::string &what, Moc *moc, const Matrix &toClip, float forward, bool flipRows = false) {
    std::string answers;
    for (Box box : kBoxes) {
        if (forward < 0) std::swap(box.lo[2], box.hi[2]);
        box.lo[2] *= forward, box.hi[2] *= forward;
        answers += " " + Text(TestBox(moc, toClip, box));
    }
    std::vector<float> depth(kWidth * kHeight);
    moc->ComputePixelDepthBuffer(depth.data(), flipRows);
    if (reference.empty()) reference = depth, expected = answers;
    Say(what, answers == expected && depth == reference, answers.substr(1));
}

static std::vector<float> Positions(float forward) {
    std::vector<float> p;
    for (const float *c : kWall) p.insert(p.end(), {c[0], c[1], 10 * forward});
    return p;
}

static void Matrices(Moc *moc) {
    const Moc::VertexLayout packed(12, 4, 8);
    const std::vector<float> right = Positions(-1), left = Positions(1);
    const auto draw = [&](const std::vector<float> &v, const unsigned *indices, const Matrix &m,
                          Moc::BackfaceWinding away) {
        moc->ClearBuffer();
        return moc->RenderTriangles(v.data(), indices, 2, m.data(), away, Moc::CLIP_PLANE_ALL, packed);
    };

    draw(right, kCounterClockwise, OpenGl(), Moc::BACKFACE_CW);
    Check("OpenGL, right-handed", moc, OpenGl(), -1);
    draw(left, kClockwise, Direct3D(), Moc::BACKFACE_CCW);
    Check("Direct3D, left-handed, fronts clockwise", moc, Direct3D(), 1);
    draw(right, kCounterClockwise, ReversedInfinite(), Moc::BACKFACE_CW);
    Check("reversed depth, no far plane", moc, ReversedInfinite(), -1);

    const Matrix rowByRow = Transposed(OpenGl());  // as some engines store it
    draw(right, kCounterClockwise, Transposed(rowByRow), Moc::BACKFACE_CW);
    Check("column vectors stored row by row", moc, Transposed(rowByRow), -1);

    const Matrix up = TurnY(Vulkan());
    draw(right, kCounterClockwise, up, Moc::BACKFACE_CW);
    Check("Vulkan, y turned up", moc, up, -1);
    const Moc::CullingResult mirrored = draw(right, kCounterClockwise, Vulkan(), Moc::BACKFACE_CW);
    Say("Vulkan's matrix as it is", mirrored == Moc::VIEW_CULLED, Text(mirrored));

    // Front faces are counter-clockwise in the mesh, and the model matrix mirrors it.
    const Matrix mirror = {{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    std::vector<float> mesh = right;
    for (size_t i = 0; i < mesh.size(); i += 3) mesh[i] = -mesh[i];
    draw(mesh, kClockwise, Product(mirror, OpenGl()), Backfaces(mirror));
    Check("a mirrored model", moc, OpenGl(), -1);
}

struct Vertex { float normal[3], position[3], uv[2]; };

// The pointer is always to the first x; the offsets are in bytes from x to y, and from x to z or w.
static void Layouts(Moc *moc) {
    const Matrix m = OpenGl();
    std::vector<float> xyz = Positions(-1), xyz1, soa(12), clip, xyw, clipSoa(12);
    std::vector<Vertex> mesh;
    for (int i = 0; i < 4; ++i) {
        const float x = xyz[3 * i], y = xyz[3 * i + 1], z = xyz[3 * i + 2];
        mesh.push_back({{0, 0, 1}, {x, y, z}, {0, 0}});
        xyz1.insert(xyz1.end(), {x, y, z, 1});
        clip.insert(clip.end(), {x * kX, y * kY, 0, -z});
        xyw.insert(xyw.end(), {x * kX, y * kY, -z});
        for (int k = 0; k < 3; ++k) {
            soa[4 * k + i] = xyz[3 * i + k];
            clipSoa[4 * k + i] = xyw[3 * i + k];
        }
    }
    struct Case { const char *what; const float *x, *matrix; Moc::VertexLayout layout; };
    const Case layouts[] = {
        // With a matrix the third offset is that of z, without one that of w.
        {"x, y, z", xyz.data(), m.data(), Moc::VertexLayout(12, 4, 8)},
        {"x, y, z, 1", xyz1.data(), m.data(), Moc::VertexLayout(16, 4, 8)},
        {"interleaved", mesh[0].position, m.data(), Moc::VertexLayout(sizeof(Vertex), 4, 8)},
        {"arrays of x, of y, of z", soa.data(), m.data(), Moc::VertexLayout(4, 4 * 4, 8 * 4)},
        {"clip space x, y, z, w", clip.data(), nullptr, Moc::VertexLayout(16, 4, 12)},
        {"clip space x, y, w", xyw.data(), nullptr, Moc::VertexLayout(12, 4, 8)},
        {"clip space, arrays of x, of y, of w", clipSoa.data(), nullptr, Moc::VertexLayout(4, 4 * 4, 8 * 4)},
    };
    for (const Case &l : layouts) {
        moc->ClearBuffer();
        moc->RenderTriangles(l.x, kCounterClockwise, 2, l.matrix, Moc::BACKFACE_CW, Moc::CLIP_PLANE_ALL, l.layout);
        Check(l.what, moc, m, -1);
    }
    // The pitfall: with a matrix, the default layout (16, 4, 12) reads the 1 as z, and the wall is behind the eye.
    const Moc::CullingResult lost = moc->RenderTriangles(xyz1.data(), kCounterClockwise, 2, m.data());
    Say("x, y, z, 1 with the default layout", lost == Moc::VIEW_CULLED, Text(lost));
}

// A wall across the view, and a box around the eye: all of its faces are behind the wall, but its contents may not be.
static void AroundTheEye(Moc *moc) {
    const float wall[16] = {-20, -20, 0, 10, 20, -20, 0, 10, 20, 20, 0, 10, -20, 20, 0, 10};
    const Box box = {{-20, -20, -20}, {20, 20, 20}};
    std::vector<float> corners;
    for (int i = 0; i < 24; ++i) corners.push_back(i / 3 >> i % 3 & 1 ? box.hi[i % 3] : box.lo[i % 3]);
    const unsigned faces[36] = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                2, 7, 3, 2, 6, 7, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    moc->ClearBuffer();
    moc->RenderTriangles(wall, kCounterClockwise, 2);
    const auto test = [&](Moc::BackfaceWinding away) {
        return Text(moc->TestTriangles(corners.data(), faces, 12, OpenGl().data(), away, Moc::CLIP_PLANE_ALL,
                                       Moc::VertexLayout(12, 4, 8)));
    };
    const std::string fronts = test(Moc::BACKFACE_CW), both = test(Moc::BACKFACE_NONE);
    Say("a box around the eye, fronts", fronts == "outside", fronts);
    Say("a box around the eye, both sides", both == "occluded", both);
    const std::string whole = Text(TestBox(moc, OpenGl(), box));
    Say("a box around the eye, TestBox", whole == "visible", whole);
}

// Boxes at and behind the near plane, x within 1 of `x`, y within 1 of 0, from z = `nearest` to z = `farthest`, with an empty
// buffer.
static void AtTheNearPlane(Moc *moc) {
    moc->ClearBuffer();
    const auto ask = [&](const char *what, float x, float nearest, float farthest, const std::string &right) {
        const Box box = {{x - 1, -1, farthest}, {x + 1, 1, nearest}};
        const std::string answer = Text(TestBox(moc, OpenGl(), box));
        Say(what, answer == right, answer);
    };
    ask("a box behind the eye", 0, 9, 5, "outside");
    ask("a box between eye and near plane", 0, -0.1f, -0.4f, "outside");
    ask("a box that ends at the near plane", 0, -0.1f, -kNear, "visible");
    ask("a box through the near plane", 0, 5, -5, "visible");
    ask("a box through the near plane, beside the view", 40, 5, -5, "outside");
    ask("a box from the near plane on", 0, -kNear, -5, "visible");
    ask("a box that is not a number", NAN, -3, -5, "visible");

    // Random boxes and random points in them: a box with a point in view is not Outside, and a box's rectangle contains its
    // points.
    unsigned state = 1;
    const auto random = [&](float lo, float hi) {
        state = state * 1664525u + 1013904223u;
        return lo + (hi - lo) * float(state >> 8) / 16777216.0f;
    };
    int wrong = 0, places[3] = {0, 0, 0};
    for (int i = 0; i < 100000; ++i) {
        Box box;
        for (int k = 0; k < 3; ++k) {
            const float size = i % 2 ? 1.0f : 12.0f, at = random(-12, 12);
            box.lo[k] = at - random(0, size), box.hi[k] = at + random(0, size);
        }
        Rect r;
        const Place place = ProjectBox(OpenGl(), box, kNear, r);
        ++places[int(place)];
        for (int k = 0; k < 4; ++k) {
            const double x = random(box.lo[0], box.hi[0]) * kX, y = random(box.lo[1], box.hi[1]) * kY;
            const double w = -random(box.lo[2], box.hi[2]);
            const bool seen = w >= kNear && std::abs(x) <= w && std::abs(y) <= w;
            const bool held = x / w >= r.xmin && x / w <= r.xmax && y / w >= r.ymin && y / w <= r.ymax && w >= r.wmin;
            wrong += seen && (place == Place::Outside || (place == Place::Rectangle && !held));
        }
    }
    const bool all = places[0] > 1000 && places[1] > 1000 && places[2] > 1000;
    Say("random boxes", wrong == 0 && all, wrong != 0 ? "points are lost" : all ? "hold their points" : "too few of a kind");
}

// A slanted wall: z is 0.2 at the left of the screen, 0.8 at the right, and so 0.5 in the middle.
static void Orthographic(Moc *moc) {
    std::vector<float> plain, deep;
    for (int i = 0; i < 4; ++i) {
        const float x = i % 3 ? 1.0f : -1.0f, y = i / 2 ? 1.0f : -1.0f, z = 0.5f + 0.3f * x;
        plain.insert(plain.end(), {x, y, z, 1});
        for (float c : FromOrthographic(x, y, z)) deep.push_back(c);
    }
    const auto ask = [&](const char *what, float w, const std::string &right) {
        const std::string answer = Text(moc->TestRect(-0.05f, -0.05f, 0.05f, 0.05f, w));
        Say(what, answer == right, answer);
    };
    moc->SetNearClipPlane(0);
    moc->ClearBuffer();
    moc->RenderTriangles(plain.data(), kCounterClockwise, 2);
    ask("orthographic, w as it is", 1, "visible");
    moc->ClearBuffer();
    moc->RenderTriangles(deep.data(), kCounterClockwise, 2);
    ask("orthographic, depth from z, behind", 1 / (2 - 0.55f), "occluded");
    ask("orthographic, depth from z, in front", 1 / (2 - 0.45f), "visible");
}

int main() {
    Moc *moc = Moc::Create();
    moc->SetResolution(kWidth, kHeight);
    moc->SetNearClipPlane(kNear);
    Matrices(moc);
    Layouts(moc);
    AroundTheEye(moc);
    AtTheNearPlane(moc);
    Orthographic(moc);
    Moc::Destroy(moc);

    // As USE_D3D 0 does. Clip space and rectangles are unchanged; row 0 is the bottom row.
    MOC_Settings settings = {};
    settings.size = sizeof(settings);
    MOC_DefaultSettings(&settings);
    settings.y_axis = MOC_Y_AXIS_UP;
    if (MOC_Create(&settings, &moc) != MOC_STATUS_OK) return 1;
    moc->SetResolution(kWidth, kHeight);
    moc->SetNearClipPlane(kNear);
    moc->RenderTriangles(Positions(-1).data(), kCounterClockwise, 2, OpenGl().data(), Moc::BACKFACE_CW,
                         Moc::CLIP_PLANE_ALL, Moc::VertexLayout(12, 4, 8));
    Check("rows from the bottom, read flipped", moc, OpenGl(), -1, true);
    Moc::Destroy(moc);
    return failed ? 1 : 0;
}
