# Puts files into a program as they are. sheetform_embed(target symbol file): the program gets
# `extern "C" const char <symbol>_begin[], <symbol>_end[];`.
function(sheetform_embed target symbol file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded/${symbol}.cpp)
  set(text "// Made by proto/cmake/embed.cmake.\n\
asm(\".section .rodata\\n.balign 16\\n.global ${symbol}_begin\\n.global ${symbol}_end\\n\"\n\
    \"${symbol}_begin:\\n.incbin \\\"${file}\\\"\\n${symbol}_end:\\n.byte 0\\n.previous\\n\");\n")
  file(CONFIGURE OUTPUT ${source} CONTENT "${text}" @ONLY)
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${source})
endfunction()
