// The main program of every test. Catch2 version 3 has its own; version 2 defines it here.
#if !__has_include(<catch2/catch_all.hpp>)
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#endif
