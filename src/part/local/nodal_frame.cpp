// Compiles the function bodies of nodal_frame-inl.h once.
#include <pliant/part/local/nodal_frame-inl.h>
