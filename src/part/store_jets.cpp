// Compiles the function bodies of store_jets-inl.h once.
#include <pliant/part/store_jets-inl.h>
