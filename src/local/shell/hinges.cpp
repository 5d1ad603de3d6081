// Compiles the functions of shell/hinges.h once for the library.
#include <pliant/local/shell/hinges-inl.h>
