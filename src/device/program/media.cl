/* The media that a ray is in: src/tracer/shade/media.rs. */

/* The materials of the media plus 1, in the order in which the ray entered them; then 0 for empty places. */
typedef struct {
  uint ids[N_MEDIA];
} Media;

/* The surface of a medium, met by a ray. */
typedef struct {
  float eta;
  int is_visible;
  Media behind;
} Interface;

/* The numbers of media by material: index, absorption of three channels, priority. */
FUNCTION GLOBAL const uint *medium_of(GLOBAL const uint *tables, uint id) {
  return tables + FIRST_MEDIUM + 5ul * (id - 1u);
}

/* Media::counting: the effective medium; 0 in a vacuum. */
FUNCTION uint effective(GLOBAL const uint *tables, const Media *media) {
  uint counting = media->ids[0];
  if (counting == 0u) return 0u;
  for (int i = 1; i < N_MEDIA && media->ids[i]; i++)
    if (medium_of(tables, media->ids[i])[4] >= medium_of(tables, counting)[4]) counting = media->ids[i];
  return counting;
}

FUNCTION float index_in(GLOBAL const uint *tables, const Media *media) {
  uint id = effective(tables, media);
  return id ? FLOAT_OF(medium_of(tables, id)[0]) : 1.0f;
}

/* Media::with */
FUNCTION Media with_medium(Media media, uint id) {
  for (int i = 0; i < N_MEDIA; i++) {
    if (media.ids[i] == 0u) {
      media.ids[i] = id;
      break;
    }
  }
  return media;
}

/* Media::without, where the medium was entered last; as before if it was not. */
FUNCTION Media without_medium(Media media, uint id) {
  int place = N_MEDIA;
  for (int i = 0; i < N_MEDIA; i++)
    if (media.ids[i] == id) place = i;
  for (int i = place; i < N_MEDIA; i++) media.ids[i] = i + 1 < N_MEDIA ? media.ids[i + 1] : 0u;
  return media;
}

/* Media::cross */
FUNCTION Interface cross_surface(GLOBAL const uint *tables, const Media *media, uint id, int enters) {
  int is_inside = 0;
  for (int i = 0; i < N_MEDIA; i++) is_inside |= media->ids[i] == id;
  Media before = *media, behind;
  if (enters) {
    behind = with_medium(*media, id);
  } else if (is_inside) {
    behind = without_medium(*media, id);
  } else {
    before = with_medium(*media, id);
    behind = *media;
  }
  float eta = index_in(tables, &before) / index_in(tables, &behind);
  Interface met = {eta, effective(tables, &before) != effective(tables, &behind), behind};
  return met;
}

/* Multiplies light by the fraction of each channel that arrives from a distance: Media::transmittance. */
FUNCTION void weaken(GLOBAL const uint *tables, const Media *media, float distance, float *light) {
  uint id = effective(tables, media);
  if (id == 0u) return;
  for (int i = 0; i < 3; i++) {
    float absorption = FLOAT_OF(medium_of(tables, id)[1 + i]);
    light[i] = light[i] * (absorption == 0.0f ? 1.0f : exponential(-absorption * distance));
  }
}
