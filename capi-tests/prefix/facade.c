/*
 * An engine that offers plugins its own C functions, some with the same names as the library's. With a prefix those names are
 * the engine's alone. Without one, and with the shared library, the class's call to MOC_ClearBuffer ends up here, recursing
 * endlessly: the exit code is then 42.
 *
 * If the first argument is the path of a shared library without a prefix, that copy is loaded and used as well.
 */
#include <stdio.h>
#include <stdlib.h>

/* engine.cpp */
int engine_create(void);
void engine_clear(void);
void engine_draw(void);
int engine_hides(void);
void engine_destroy(void);

#ifdef MOC_SYMBOL_PREFIX
int MOC_TestRect(void); /* engine.cpp */
int MOC_Destroy(void);  /* plugin.c */
int plugin_with(const char *path);
#endif

int MOC_ClearBuffer(void);

static int clears, depth;

int MOC_ClearBuffer(void)
{
    if (depth != 0)
        exit(42);
    ++depth;
    engine_clear();
    --depth;
    return ++clears;
}

static void expect(int condition, const char *what)
{
    if (!condition)
    {
        fprintf(stderr, "not so: %s\n", what);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    expect(engine_create(), "the engine has an object");
    expect(MOC_ClearBuffer() == 1, "the facade clears");
    engine_draw();
    expect(engine_hides(), "the wall hides");
    expect(MOC_ClearBuffer() == 2, "the facade clears again");
    expect(!engine_hides(), "nothing hides after a clear");
#ifdef MOC_SYMBOL_PREFIX
    expect(MOC_TestRect() == 1000, "a facade in the file of the class");
    expect(MOC_Destroy() == 2000, "a facade in a C file that includes the library's header");
    if (argc > 1)
    {
        const int line = plugin_with(argv[1]);
        if (line != 0)
            fprintf(stderr, "plugin.c: line %d\n", line);
        expect(line == 0, "a copy without a prefix works as well");
    }
#else
    (void)argc;
    (void)argv;
#endif
    engine_destroy();
    expect(clears == 2, "the facade was called by the engine only");
    return 0;
}
