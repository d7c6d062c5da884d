MeshVersionFormatted 2
Dimension 3
SolAtVertices
2
1 3
1 0 2 0 0.5 3
100 0 1 0 0 1e4
End
