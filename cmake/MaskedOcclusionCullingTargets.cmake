# Defines the targets for the build tree (CMakeLists.txt) and for the installed package (MaskedOcclusionCullingConfig),
# which set these variables:
#   _moc_include   the folder of the headers
#   _moc_static    the archive; empty if it is not there
#   _moc_shared    the shared library; empty if it is not there
#   _moc_import    its import library (Windows)
#   _moc_soname    the file name recorded in programs, by which the loader finds the library (not Windows)
#   _moc_native    the system libraries that the archive needs
#   _moc_definitions  what programs must define: MOC_SYMBOL_PREFIX, if there is a prefix
#   _moc_scope     GLOBAL or nothing
# They apply to every configuration, because cargo's build does not depend on the program's build type.
# With MSVC Rust always uses the release C runtime, so programs that link the archive need /MD in debug builds, too.

if(_moc_static)
    add_library(MaskedOcclusionCulling::MaskedOcclusionCulling_static STATIC IMPORTED ${_moc_scope})
    set_target_properties(MaskedOcclusionCulling::MaskedOcclusionCulling_static PROPERTIES
        IMPORTED_LOCATION "${_moc_static}"
        INTERFACE_INCLUDE_DIRECTORIES "${_moc_include}"
        INTERFACE_COMPILE_DEFINITIONS "${_moc_definitions}"
        INTERFACE_LINK_LIBRARIES "${_moc_native}")
endif()

if(_moc_shared)
    add_library(MaskedOcclusionCulling::MaskedOcclusionCulling_shared SHARED IMPORTED ${_moc_scope})
    set_target_properties(MaskedOcclusionCulling::MaskedOcclusionCulling_shared PROPERTIES
        IMPORTED_LOCATION "${_moc_shared}"
        INTERFACE_INCLUDE_DIRECTORIES "${_moc_include}"
        INTERFACE_COMPILE_DEFINITIONS "${_moc_definitions}")
    if(_moc_import)
        set_property(TARGET MaskedOcclusionCulling::MaskedOcclusionCulling_shared PROPERTY IMPORTED_IMPLIB "${_moc_import}")
    elseif(_moc_soname)
        set_property(TARGET MaskedOcclusionCulling::MaskedOcclusionCulling_shared PROPERTY IMPORTED_SONAME "${_moc_soname}")
    endif()
endif()

set(_moc_kind static)
if(MaskedOcclusionCulling_SHARED OR (NOT DEFINED MaskedOcclusionCulling_SHARED AND BUILD_SHARED_LIBS))
    set(_moc_kind shared)
endif()
if(TARGET MaskedOcclusionCulling::MaskedOcclusionCulling_${_moc_kind})
    add_library(MaskedOcclusionCulling::MaskedOcclusionCulling INTERFACE IMPORTED ${_moc_scope})
    set_property(TARGET MaskedOcclusionCulling::MaskedOcclusionCulling
        PROPERTY INTERFACE_LINK_LIBRARIES MaskedOcclusionCulling::MaskedOcclusionCulling_${_moc_kind})
endif()
