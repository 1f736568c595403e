# Builds the page for browsers into the program: every file below a folder, found at configure time and again whenever
# one comes or goes. A folder that is not there gives a program without a page.
set(SHEETFORM_WEB_DIST ${PROJECT_SOURCE_DIR}/web/dist CACHE PATH "Folder of the built page")

function(sheetform_embed_page target)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${SHEETFORM_WEB_DIST} ${SHEETFORM_WEB_DIST}/*)
  list(SORT files)
  set(declarations "")
  set(entries "")
  set(number 0)
  foreach(file IN LISTS files)
    set(symbol sheetform_page_${number})
    sheetform_embed(${target} ${symbol} ${SHEETFORM_WEB_DIST}/${file})
    string(APPEND declarations "extern \"C\" const char ${symbol}_begin[], ${symbol}_end[];\n")
    string(APPEND entries "    {\"${file}\", ${symbol}_begin, ${symbol}_end},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(table ${CMAKE_CURRENT_BINARY_DIR}/page_table.cpp)
  set(text "// Made by server/cmake/page.cmake.\n#include \"server/http/page_files.h\"\n\n${declarations}
namespace sheetform::server {\nconst BuiltInFile kBuiltInFiles[] = {\n${entries}    {nullptr, nullptr, nullptr}};
}  // namespace sheetform::server\n")
  file(CONFIGURE OUTPUT ${table} CONTENT "${text}" @ONLY)
  target_sources(${target} PRIVATE ${table})
endfunction()
