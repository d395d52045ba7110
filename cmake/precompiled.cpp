// Holds the precompiled header of all libraries (CMakeLists.txt).
