// Nothing but the headers that tests share, which are compiled once for all (tests/CMakeLists.txt).
