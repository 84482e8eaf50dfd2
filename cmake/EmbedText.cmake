# cmake -D TEXT=file -D CODE=file.cpp -D HEADER=name.h -D FUNCTION=name -P EmbedText.cmake
# Writes a source file whose function gives the text of a file. The build runs it when the text changes.
file(READ "${TEXT}" text)
string(FIND "${text}" ")text\"" closing)
if(NOT closing EQUAL -1)
    message(FATAL_ERROR "${TEXT}: holds the mark that ends a raw string")
endif()
file(WRITE "${CODE}" "#include \"${HEADER}\"

std::string_view chromeball::${FUNCTION}() {
    return R\"text(${text})text\";
}
")
