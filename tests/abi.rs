//! The binary interface: sizes and offsets of structs, values of enumerations, and the functions, as listed in
//! `tests/abi.txt`. Here the library is compared with the list, and a C compiler compares the header, so that compiled
//! programs keep working. `UPDATE_ABI=1 cargo test --test abi` adds new entries; existing entries are removed or
//! changed by hand, together with MOC_ABI_VERSION. The list is for 64-bit pointers; `tests/abi-32.txt` has the
//! differences with 32-bit ones (run by `.ci/i686`).
#![cfg(all(target_os = "linux", feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::mem::offset_of;

use masked_occlusion_culling::capi::*;

/// A function has no value.
type List = BTreeMap<String, Option<i64>>;

macro_rules! structs {
    ($list:ident: $($name:ident { $($field:ident)* })*) => {$(
        $list.insert(format!("sizeof({})", stringify!($name)), Some(size_of::<$name>() as i64));
        $($list.insert(
            format!("offsetof({}, {})", stringify!($name), stringify!($field)),
            Some(offset_of!($name, $field) as i64),
        );)*
        // A compile error unless every field is listed.
        #[allow(clippy::redundant_closure_call)]
        let _ = |$name { $($field: _),* }: $name| ();
    )*};
}

macro_rules! enumerations {
    ($list:ident: $($name:ident { $($value:ident)* })*) => {$(
        $($list.insert(stringify!($value).into(), Some($name::$value as i64));)*
        // A compile error unless every value is listed.
        let _ = |of: $name| match of { $($name::$value => ()),* };
    )*};
}

fn of_the_library() -> List {
    let mut list = List::new();
    list.insert("MOC_ABI_VERSION".into(), Some(MOC_ABI_VERSION.into()));
    list.insert("MOC_RESULT_UNKNOWN".into(), Some(MOC_RESULT_UNKNOWN.into()));
    list.insert("MOC_UNCHECKED".into(), Some(MOC_UNCHECKED.into()));
    structs! { list:
        MOC_Settings { size implementation update_rule y_axis statistics alloc free call_alloc }
        MOC_Mesh {
            size index_size vertices indices vertex_count triangle_count model_to_clip layout winding clip_planes
        }
        MOC_ThreadpoolSettings {
            size threads bins_w bins_h max_jobs processors external_threads reserved thread_name thread_start user
        }
        MOC_VertexLayout { stride offset_y offset_zw }
        MOC_ScissorRect { min_x min_y max_x max_y }
        MOC_TriList { capacity count data }
        MOC_OccluderStatistics {
            num_processed_triangles num_rasterized_triangles num_tiles_traversed num_tiles_updated num_tiles_merged
        }
        MOC_OccludeeStatistics {
            num_processed_rectangles num_processed_triangles num_rasterized_triangles num_tiles_traversed
        }
        MOC_Statistics { size reserved occluders occludees }
        MOC_RecordingInfo { size near_clip_plane width height num_calls }
        MOC_RecordedCall { size kind result rect mesh vertex_floats }
    }
    enumerations! { list:
        MOC_Status {
            MOC_STATUS_OK MOC_STATUS_NULL_POINTER MOC_STATUS_INVALID_ENUM MOC_STATUS_INVALID_SIZE
            MOC_STATUS_INVALID_NUMBER MOC_STATUS_INVALID_LAYOUT MOC_STATUS_NO_BUFFER MOC_STATUS_INDEX_OUT_OF_RANGE
            MOC_STATUS_SIZE_MISMATCH MOC_STATUS_LIST_FULL MOC_STATUS_OUT_OF_MEMORY MOC_STATUS_INTERNAL MOC_STATUS_FILE
            MOC_STATUS_INVALID_RECORDING MOC_STATUS_BUSY
        }
        MOC_Implementation { MOC_SCALAR MOC_SSE2 MOC_SSE41 MOC_AVX2 MOC_AVX512 MOC_NEON MOC_SIMD128 }
        MOC_UpdateRule {
            MOC_UPDATE_RULE_THREE_LAYER MOC_UPDATE_RULE_QUICK MOC_UPDATE_RULE_ACCURATE MOC_UPDATE_RULE_FOUR_LAYER
        }
        MOC_YAxis { MOC_Y_AXIS_DOWN MOC_Y_AXIS_UP }
        MOC_BackfaceWinding { MOC_BACKFACE_NONE MOC_BACKFACE_CW MOC_BACKFACE_CCW }
        MOC_CullingResult { MOC_VISIBLE MOC_OCCLUDED MOC_VIEW_CULLED }
        MOC_ClipPlanes {
            MOC_CLIP_PLANE_NONE MOC_CLIP_PLANE_NEAR MOC_CLIP_PLANE_LEFT MOC_CLIP_PLANE_RIGHT MOC_CLIP_PLANE_BOTTOM
            MOC_CLIP_PLANE_TOP MOC_CLIP_PLANE_SIDES MOC_CLIP_PLANE_ALL
        }
        MOC_RecordedCallKind {
            MOC_RECORDED_RENDER_TRIANGLES MOC_RECORDED_TEST_RECT MOC_RECORDED_TEST_TRIANGLES MOC_RECORDED_CLEAR_BUFFER
        }
    }
    list.extend(native::exported_symbols().into_iter().map(|name| (format!("{name}()"), None)));
    list
}

const LIST: &str = "tests/abi.txt";
const DIFFERENCES: &str = "tests/abi-32.txt";
const IS_32_BIT: bool = cfg!(target_pointer_width = "32");

fn read(file: &str) -> List {
    let text = std::fs::read_to_string(native::root().join(file)).unwrap_or_default();
    let entry = |line: &str| match line.split_once(" = ") {
        Some((name, number)) => (name.into(), Some(number.parse().expect("a number"))),
        None => (line.into(), None),
    };
    text.lines().map(entry).collect()
}

fn committed() -> List {
    let mut list = read(LIST);
    if IS_32_BIT {
        list.extend(read(DIFFERENCES));
    }
    list
}

fn write(file: &str, list: &List) {
    let line = |(name, number): (&String, &Option<i64>)| match number {
        Some(number) => format!("{name} = {number}\n"),
        None => format!("{name}\n"),
    };
    std::fs::write(native::root().join(file), list.iter().map(line).collect::<String>()).expect("the list is written");
}

#[test]
fn the_library_is_what_programs_were_compiled_with() {
    let now = of_the_library();
    if std::env::var_os("UPDATE_ABI").is_some_and(|v| v == "1") {
        let file = if IS_32_BIT { DIFFERENCES } else { LIST };
        let (all, mut listed) = (read(LIST), read(file));
        let differs = |name: &String, number| !IS_32_BIT || all.get(name) != Some(number);
        for (name, number) in now.iter().filter(|(name, number)| differs(name, number)) {
            listed.entry(name.clone()).or_insert(*number);
        }
        write(file, &listed);
    }
    let listed = committed();
    for (name, number) in &listed {
        match now.get(name) {
            Some(is) => assert_eq!(is, number, "{name} changed"),
            None => panic!("{name} is gone"),
        }
    }
    for name in now.keys() {
        assert!(listed.contains_key(name), "{name} is new: run `UPDATE_ABI=1 cargo test --test abi` and commit it");
    }
    assert!(listed.len() > 120, "only {} entries", listed.len());
}

/// Compares the same values and functions with the header, in C and in C++.
#[test]
fn the_header_says_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut source = String::from("#include \"masked_occlusion_culling.h\"\n\nvoid *functions[] = {\n");
    let listed = committed();
    for name in listed.iter().filter(|(_, number)| number.is_none()).map(|(name, _)| name.trim_end_matches("()")) {
        writeln!(source, "    (void *){name},").expect("a string");
    }
    source.push_str("};\n\n");
    for (k, (name, number)) in listed.iter().enumerate() {
        if let Some(number) = number {
            writeln!(source, "typedef char check_{k}[(long long)({name}) == {number} ? 1 : -1]; /* {name} */")
                .expect("a string");
        }
    }
    for (cpp, file) in [(false, "abi.c"), (true, "abi.cpp")] {
        let file = folder.path().join(file);
        std::fs::write(&file, &source).expect("a file");
        let mut build = native::target().compiler(cpp, folder.path());
        let mut command = build.opt_level(0).debug(false).get_compiler().to_command();
        command.arg("-fsyntax-only").arg("-I").arg(native::root().join("include")).arg(&file);
        let output = command.output().expect("a compiler");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
