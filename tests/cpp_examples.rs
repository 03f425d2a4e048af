//! The programs of cpp-examples compile without a warning, run, and print what they should, with the library linked
//! either statically or dynamically.
#![cfg(all(feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::path::Path;

use native::{Link, Program};

/// The output of a program, linked statically and dynamically.
fn outputs(source: &str) -> [String; 2] {
    [Link::Static, Link::Shared].map(|link| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = compile(source, link, &[], folder.path());
        native::run(&mut native::target().command(program)).unwrap_or_else(|e| panic!("{source}, {link:?}: {e}"))
    })
}

fn compile(source: &str, link: Link, defines: &[(&str, &str)], out: &Path) -> std::path::PathBuf {
    let source = native::root().join("cpp-examples").join(source);
    let flags = [if native::target().is_msvc() { "/WX" } else { "-Werror" }];
    native::build(&Program { source: &source, out, link, defines, flags: &flags }).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn first_triangle() {
    for output in outputs("first_triangle.cpp") {
        let answers: Vec<&str> = output.lines().filter_map(|l| l.rsplit_once(": ")).map(|(_, a)| a.trim()).collect();
        assert_eq!(answers, ["occluded", "visible", "visible", "outside the view", "occluded"], "{output}");
    }
}

#[test]
fn switching_over() {
    for output in outputs("switching_over.cpp") {
        assert!(output.contains("depth at the centre: 0.1000"), "{output}");
        assert!(output.contains("allocations left: 0"), "{output}");
    }
}

#[test]
fn bins_and_threads() {
    for output in outputs("bins_and_threads.cpp") {
        assert!(output.contains("one thread and four agree: yes"), "{output}");
        assert!(!output.contains(" 0.0% of the screen"), "{output}");
    }
}

#[test]
fn thread_pool() {
    for output in outputs("thread_pool.cpp") {
        let answers: Vec<&str> = output.lines().filter_map(|l| l.rsplit_once(": ")).map(|(_, a)| a.trim()).collect();
        assert_eq!(answers[..3], ["occluded", "visible", "occluded"], "{output}");
        assert!(!answers[3].starts_with("0 "), "{output}");
    }
}

#[test]
fn plain_c() {
    for output in outputs("plain_c.c") {
        assert!(output.contains("behind the square: occluded"), "{output}");
        assert!(output.contains("an index too high: "), "{output}");
    }
}

#[test]
fn conventions() {
    let asked = "occluded visible visible visible outside visible";
    for output in outputs("conventions.cpp") {
        let answers: Vec<(&str, &str)> = output.lines().filter_map(|line| line.rsplit_once(": ")).collect();
        let others = [
            ("Vulkan's matrix as it is", "outside"),
            ("x, y, z, 1 with the default layout", "outside"),
            ("a box around the eye, fronts", "outside"),
            ("a box around the eye, both sides", "occluded"),
            ("a box around the eye, TestBox", "visible"),
            ("a box behind the eye", "outside"),
            ("a box between eye and near plane", "outside"),
            ("a box that ends at the near plane", "visible"),
            ("a box through the near plane", "visible"),
            ("a box through the near plane, beside the view", "outside"),
            ("a box from the near plane on", "visible"),
            ("a box that is not a number", "visible"),
            ("random boxes", "hold their points"),
            ("orthographic, w as it is", "visible"),
            ("orthographic, depth from z, behind", "occluded"),
            ("orthographic, depth from z, in front", "visible"),
        ];
        for other in others {
            assert!(answers.contains(&other), "{other:?}: {output}");
        }
        assert_eq!(answers.iter().filter(|(_, answer)| *answer == asked).count(), 14, "{output}");
        assert_eq!(answers.len(), 14 + others.len(), "{output}");
    }
}

/// Every C++ snippet in docs/conventions.md is in the program verbatim.
#[test]
fn the_conventions_are_quoted_exactly() {
    let read = |path: &str| std::fs::read_to_string(native::root().join(path)).expect(path).replace("\r\n", "\n");
    let (document, program) = (read("docs/conventions.md"), read("cpp-examples/conventions.cpp"));
    // A snippet may be indented differently, so lines are compared without their indentation.
    let plain = |text: &str| text.lines().map(str::trim_start).collect::<Vec<_>>().join("\n");
    let program = plain(&program);
    let quotes: Vec<&str> = document.split("```cpp\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(quotes.len() > 6, "only {} quotations", quotes.len());
    for quote in quotes {
        assert!(program.contains(plain(quote).trim_end()), "not in the program:\n{quote}");
    }
}

/// The example frame at the beginning of the C header compiles without a warning, runs, and gives the right result.
#[test]
fn the_frame_in_the_header() {
    let header =
        std::fs::read_to_string(native::root().join("include/masked_occlusion_culling.h")).expect("the header");
    let code = header.lines().skip_while(|line| !line.contains("#include \"masked_occlusion_culling.h\""));
    let code: Vec<&str> = code.take_while(|line| *line != " */").map(|l| l.trim_start_matches(" *")).collect();
    let end = code.iter().position(|line| *line == "     }").expect("the end of main");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let source = folder.path().join("frame.c");
    std::fs::write(&source, code[..=end].join("\n") + "\n").expect("the program is written");
    for link in [Link::Static, Link::Shared] {
        let program = compile(&source.display().to_string(), link, &[], folder.path());
        let output = native::run(&mut native::target().command(program)).unwrap_or_else(|e| panic!("{link:?}: {e}"));
        assert_eq!(output.trim(), "hidden", "{output}");
    }
}

/// Runs the demo program on a scene of three squares: one hides another, and the third is next to them.
#[test]
fn demo_culls_what_is_behind() {
    let mut bytes = b"MOCDEMO1".to_vec();
    let mut words = |words: &[u32]| words.iter().for_each(|w| bytes.extend(w.to_le_bytes()));
    let mut floats = |list: &[f32]| words(&list.iter().map(|f| f.to_bits()).collect::<Vec<_>>());
    // Half width, centre x and distance; the camera looks along +z, so w is z.
    let squares = [(2.0f32, 0.0f32, 5.0f32), (1.0, 0.0, 9.0), (0.5, 5.0, 9.0), (1.0, 50.0, 9.0), (1.0, 0.0, 0.1)];
    let mut header = [0.0f32; 17];
    header[0] = 0.25;
    (header[1], header[6], header[12]) = (1.0, 1.0, 1.0);
    let counts = [320, 200, squares.len() as u32 * 4, squares.len() as u32 * 6, squares.len() as u32];
    floats(&counts.map(f32::from_bits));
    floats(&header);
    let corners = |&(half, x, z): &(f32, f32, f32)| {
        [[x - half, -half, z], [x + half, -half, z], [x + half, half, z], [x - half, half, z]]
    };
    squares.iter().for_each(|s| floats(corners(s).as_flattened()));
    squares.iter().for_each(|_| floats(&[0, 1, 2, 0, 2, 3].map(f32::from_bits)));
    for (i, square) in squares.iter().enumerate() {
        let [lo, _, hi, _] = corners(square);
        // Only the first one is an occluder.
        floats(&[i as u32 * 4, i as u32 * 6, 2, u32::from(i == 0)].map(f32::from_bits));
        floats(&lo);
        floats(&hi);
    }

    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, result) = (folder.path().join("scene"), folder.path().join("result"));
    std::fs::write(&scene, &bytes).expect("the scene is written");
    for rule in [&[][..], &[("QUICK_MASK", "1")], &[("QUICK_MASK", "0")], &[("MOC_FOUR_LAYERS", "1")]] {
        let program = compile("demo.cpp", Link::Static, rule, folder.path());
        let output =
            native::run(native::target().command(program).arg(&scene).arg(&result)).unwrap_or_else(|e| panic!("{e}"));
        assert!(output.contains("33.3% of those in view"), "{output}");
        let found = std::fs::read(&result).expect("the result is written");
        assert_eq!(found[..5], [0, 1, 0, 3, 3], "{rule:?}");
        let depth: Vec<f32> = found[5..].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        assert_eq!(depth.len(), 320 * 200);
        assert!((depth[100 * 320 + 160] - 0.2).abs() < 1e-6, "{}", depth[100 * 320 + 160]);
        assert!(depth[0] < 0.0);
    }

    // A truncated file is rejected.
    std::fs::write(&scene, &bytes[..200]).expect("the scene is written");
    let program = compile("demo.cpp", Link::Static, &[], folder.path());
    let error =
        native::run(native::target().command(program).arg(&scene).arg(&result)).expect_err("a cut scene is accepted");
    assert!(error.contains("cut short"), "{error}");
}

/// README.md's frames in C++ and C compile without a warning, run, and give the right result.
#[test]
fn the_frames_in_the_readme() {
    let readme = std::fs::read_to_string(native::root().join("README.md")).expect("README.md").replace("\r\n", "\n");
    for (language, file) in [("cpp", "frame.cpp"), ("c", "frame.c")] {
        let code = readme.split(&format!("```{language}\n")).nth(1).and_then(|rest| rest.split("```").next());
        let folder = tempfile::tempdir().expect("a temporary folder");
        let source = folder.path().join(file);
        std::fs::write(&source, code.expect("a program")).expect("the program is written");
        for link in [Link::Static, Link::Shared] {
            let program = compile(&source.display().to_string(), link, &[], folder.path());
            let output =
                native::run(&mut native::target().command(program)).unwrap_or_else(|e| panic!("{link:?}: {e}"));
            assert_eq!(output.trim(), "hidden", "{file}, {link:?}: {output}");
        }
    }
}
