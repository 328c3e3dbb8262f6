# cmake -D OUTPUT=FILE.cpp -D FOLDER=web -P embed.cmake: the report's three files as a C++ source.
# Each becomes a raw string; its end mark occurs in none of them.
set(text "#include \"client/report/resources.hpp\"\n\nnamespace landmarkdb::client {\n\n")
foreach(kind Html Css Js)
  string(TOLOWER ${kind} extension)
  file(READ ${FOLDER}/report.${extension} content)
  string(FIND "${content}" ")landmarkdb\"" end_mark)
  if(NOT end_mark EQUAL -1)
    message(FATAL_ERROR "${FOLDER}/report.${extension} holds the mark that ends a raw string")
  endif()
  string(APPEND text "const std::string_view kReport${kind} = R\"landmarkdb(${content})landmarkdb\";\n\n")
endforeach()
string(APPEND text "}  // namespace landmarkdb::client\n")
file(WRITE ${OUTPUT} "${text}")
