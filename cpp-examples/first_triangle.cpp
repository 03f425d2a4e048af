// The smallest program: draw one triangle as an occluder and ask what it hides.
#include "MaskedOcclusionCulling.h"

#include <cstdio>

static const char *Text(MaskedOcclusionCulling::CullingResult result) {
    switch (result) {
        case MaskedOcclusionCulling::VISIBLE: return "visible";
        case MaskedOcclusionCulling::OCCLUDED: return "occluded";
        default: return "outside the view";
    }
}

int main() {
    // An object on the best instruction set that this processor has.
    MaskedOcclusionCulling *moc = MaskedOcclusionCulling::Create();

    // A buffer, once; then for each frame: clear, render occluders, test occludees.
    moc->SetResolution(640, 360);
    moc->SetNearClipPlane(0.1f);
    moc->ClearBuffer();

    // Vertices are in clip space: x, y, z, w; z is not read. A point is on screen if -w <= x <= w and -w <= y <= w, and
    // w is the distance from the eye. This triangle is 5 away and covers much of the screen.
    const float vertices[] = {
        -4.0f, -4.0f, 0.0f, 5.0f,
        4.0f, -4.0f, 0.0f, 5.0f,
        0.0f, 4.0f, 0.0f, 5.0f,
    };
    // Triangles that are counter-clockwise on the screen are front-facing; clockwise ones are skipped unless
    // BACKFACE_NONE is passed.
    const unsigned triangle[] = {0, 1, 2};
    moc->RenderTriangles(vertices, triangle, 1);

    // A small box in the middle of the screen. Rectangles are in normalised device coordinates: x/w and y/w.
    std::printf("behind the triangle, 8 away:       %s\n", Text(moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 8.0f)));
    std::printf("in front of it, 3 away:            %s\n", Text(moc->TestRect(-0.1f, -0.1f, 0.1f, 0.1f, 3.0f)));
    std::printf("beside it, 8 away:                 %s\n", Text(moc->TestRect(-0.9f, 0.6f, -0.7f, 0.8f, 8.0f)));
    std::printf("off the screen:                    %s\n", Text(moc->TestRect(1.5f, -0.1f, 1.7f, 0.1f, 8.0f)));

    // Meshes can be tested too. This one is behind the triangle.
    const float small[] = {
        -0.5f, -0.5f, 0.0f, 6.0f,
        0.5f, -0.5f, 0.0f, 6.0f,
        0.0f, 0.5f, 0.0f, 6.0f,
    };
    std::printf("a triangle behind it, 6 away:      %s\n", Text(moc->TestTriangles(small, triangle, 1)));

    MaskedOcclusionCulling::Destroy(moc);
}
